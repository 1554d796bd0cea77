// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "swarm_core/base/shared.hpp"
#include "swarmflow/core/gaussian.hpp"
#include "swarmflow/robot/control_method.hpp"

namespace swarm::agent {

/// How arrived robots make room and keep their slots.
struct GoalSlotOptions {
  double radius_m = 0.2;
  double room_gap_m = 0.4;  ///< a neighbour nearer than this pushes; above the filter's margin
  double room_gain_hz = 3.0;
  double inner_share = 0.75;   ///< factor on the push of a neighbour that is farther in
  double outside_share = 3.0;  ///< factor on the push of a neighbour outside of the goal
  double approach_gain_hz = 0.8;
  double approach_max_mps = 0.4;  ///< of a robot that has arrived, to its slot
  double scale = 1.0;             ///< of the other distances (body_scale.hpp)
};

/// A robot's slot in the goal, and how all robots find room in it.
///
/// Every robot has a slot of its own, but in a full goal the paths to the inner slots are blocked
/// by robots that came before. Three rules, which need only the states of neighbours, let all
/// robots in:
///
///   - one that has come no nearer to its slot for 2 s takes its position as its slot, if that is
///     in the goal's 99 % ellipse; otherwise it heads for the goal's mean, or again for its slot;
///   - one that has arrived makes room: it moves away from neighbours nearer than room_gap,
///
///       u = k Σ_j w_j (D_j − d_j) (x − x_j)/d_j
///
///     with d_j the distance of the centres, D_j = r + r_j + room_gap, and w_j = outside_share for
///     those outside of the ellipse, 1 for those farther out than itself in Mahalanobis distance,
///     inner_share for the others, so that pressure from outside is passed on inwards to where
///     there is room;
///   - its slot moves with it while it makes room, but not out of the goal: beyond the rim of the
///     ellipse it drives inwards, the faster the nearer to the edge.
///
/// So a full goal fills up evenly, and in one with room the robots keep their planned slots.
class GoalSlot {
 public:
  GoalSlot() = default;
  GoalSlot(const Gaussian& goal, const Vec2& slot_m, Shared<GoalSlotOptions> options);

  /// To be called once a tick. Arrived: well inside the ellipse and within 1 m of its slot.
  bool has_arrived(SteadyTime now, const Vec2& position_m);

  bool is_in_goal(const Vec2& position_m) const { return goal_.contains_99(position_m); }

  /// Whether a position is in the goal or at most a third of its size beside it.
  bool is_beside(const Vec2& position_m) const {
    constexpr double kBeside = 16.0;  // squared Mahalanobis distance: 4/3 of the 99 % ellipse
    return goal_.mahalanobis_squared(position_m) < kBeside;
  }

  /// Whether it heads for the mean, after 2 s without progress outside of the goal.
  bool is_blocked() const { return blocked_; }

  double left_m(const Vec2& position_m) const { return (slot_m_ - position_m).norm(); }

  /// Where to head for.
  const Vec2& aim_m() const { return blocked_ ? goal_.mean_m() : slot_m_; }

  /// Restarts the time without progress: the robot is held.
  void wait(SteadyTime now) { progress_at_ = now; }

  /// Desired velocity of a robot that has arrived [m/s]. O(neighbours).
  Vec2 keep(const ControlView& view);

 private:
  Vec2 room(const ControlView& view) const;

  Shared<GoalSlotOptions> options_;
  Gaussian goal_;
  Vec2 slot_m_ = Vec2::Zero();
  double nearest_m_ = std::numeric_limits<double>::infinity();
  SteadyTime progress_at_;
  bool arrived_ = false;
  bool blocked_ = false;
};

}  // namespace swarm::agent
