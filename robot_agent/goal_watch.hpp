// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <limits>

#include "swarmflow/core/gaussian.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::agent {

/// Whether a robot has arrived: inside its goal's 99 % ellipse and within 1 m of its own end point,
/// or within 4 m if other robots have let it no nearer for 3 s. After 15 s without coming nearer,
/// as behind a new obstacle, any place well inside the ellipse (96 %) is enough. Once arrived it
/// stays so while it is inside the ellipse. The lengths are multiplied by `scale` (body_scale.hpp).
class GoalWatch {
 public:
  GoalWatch() = default;
  GoalWatch(const Gaussian& goal, const Vec2& end_m, double scale = 1.0)
      : goal_(goal), end_m_(end_m), scale_(scale) {}

  /// Whether it watches this end point in this goal: then a new plan does not reset it.
  bool is_for(const Gaussian& goal, const Vec2& end_m) const {
    constexpr double kSame_m = 1e-6;
    return (goal.mean_m() - goal_.mean_m()).norm() < kSame_m && (end_m - end_m_).norm() < kSame_m;
  }

  /// To be called at every tick: it also keeps the time of the last progress.
  bool has_arrived(SteadyTime now, const Vec2& position_m) {
    const bool inside = goal_.contains_99(position_m);
    if (arrived_) return arrived_ = inside;
    const double left_m = (end_m_ - position_m).norm();
    if (left_m < nearest_m_ - scale_ * kProgress_m) {
      nearest_m_ = left_m;
      progress_at_ = now;
    }
    const Duration stalled = now - progress_at_;
    const bool dense = left_m < scale_ * kDense_m && stalled > kDenseAfter;
    // At the rim others could push it out again.
    const bool blocked =
        stalled > kBlockedAfter && goal_.mahalanobis_squared(position_m) < kWellInside;
    return arrived_ = inside && (left_m < scale_ * kNear_m || dense || blocked);
  }

 private:
  static constexpr double kNear_m = 1.0;
  static constexpr double kDense_m = 4.0;
  static constexpr double kProgress_m = 0.1;
  static constexpr Duration kDenseAfter = std::chrono::seconds(3);
  static constexpr Duration kBlockedAfter = std::chrono::seconds(15);
  static constexpr double kWellInside = 6.44;  // squared Mahalanobis distance of the 96 % ellipse

  Gaussian goal_;
  Vec2 end_m_ = Vec2::Zero();
  double scale_ = 1.0;
  double nearest_m_ = std::numeric_limits<double>::infinity();
  SteadyTime progress_at_;
  bool arrived_ = false;
};

}  // namespace swarm::agent
