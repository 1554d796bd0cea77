// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarm_core/base/linalg.hpp"
#include "swarm_core/base/random.hpp"
#include "swarm_core/base/time.hpp"

namespace swarm::agent {

struct KickOptions {
  double progress_m = 0.3;    ///< less than this on the way …
  Duration stuck_after{};     ///< … in this time is stuck
  Duration duration{};        ///< of one kick
  double velocity_mps = 0.8;  ///< σ per axis
};

/// Frees a robot from a local minimum by intermittent diffusion (a first version of Alg. 1 of the
/// intermittent-diffusion paper): gradient flow alone until the robot is stuck, then for a while a
/// random velocity ξ ~ N(0, σ²I) drawn once is added, then gradient flow again.
class DiffusionKick {
 public:
  explicit DiffusionKick(const KickOptions& options) : options_(options) {}

  /// Velocity to add to the wish; zero unless a kick is on. `progress_m` grows along the way.
  /// `wants_to_move` false (waiting, arrived) forgets everything.
  Vec2 update(SteadyTime now, double progress_m, bool wants_to_move, Rng& rng);

  /// The way is another one: its progress is not to be compared with the last one's.
  void forget() { watching_ = false; }

  std::uint32_t kicks() const { return kicks_; }

 private:
  KickOptions options_;
  bool watching_ = false;
  double best_progress_m_ = 0.0;
  SteadyTime best_at_;
  SteadyTime kick_until_;
  Vec2 kick_mps_ = Vec2::Zero();
  std::uint32_t kicks_ = 0;
};

}  // namespace swarm::agent
