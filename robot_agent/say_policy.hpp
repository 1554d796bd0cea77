// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "swarm_core/base/linalg.hpp"
#include "swarm_core/base/time.hpp"

namespace swarm::agent {

struct SayOptions {
  double error_m = 0.05;    ///< speak when others' extrapolation of us is off by more
  Duration interval_max{};  ///< or when we have been silent this long
  double near_m = 1.0;      ///< or at every tick while it moves and a neighbour's surface is nearer
  Duration period{};        ///< until it can speak again
};

/// When a robot speaks (dead reckoning): others extrapolate its last state linearly, it does the
/// same and speaks before the difference matters.
class SayPolicy {
 public:
  explicit SayPolicy(const SayOptions& options) : options_(options) {}

  bool must_say(SteadyTime now, const Vec2& position_m, const Vec2& velocity_mps,
                double nearest_gap_m) const {
    if (!said_) return true;
    if (now - at_ >= options_.interval_max) return true;
    const bool stands = velocity_mps == velocity_mps_ && velocity_mps.norm() < kStands_mps;
    if (nearest_gap_m < options_.near_m && !stands) return true;
    // Whoever turns only now will be where nobody expects it before it can speak again.
    const Vec2 believed_m = position_m_ + to_seconds(now - at_) * velocity_mps_;
    const Vec2 off_m = believed_m - position_m;
    const Vec2 soon_off_m = off_m + to_seconds(options_.period) * (velocity_mps_ - velocity_mps);
    return std::max(off_m.norm(), soon_off_m.norm()) > options_.error_m;
  }

  void said(SteadyTime now, const Vec2& position_m, const Vec2& velocity_mps) {
    said_ = true;
    at_ = now;
    position_m_ = position_m;
    velocity_mps_ = velocity_mps;
  }

 private:
  static constexpr double kStands_mps = 0.01;

  SayOptions options_;
  bool said_ = false;
  SteadyTime at_;
  Vec2 position_m_ = Vec2::Zero();
  Vec2 velocity_mps_ = Vec2::Zero();
};

}  // namespace swarm::agent
