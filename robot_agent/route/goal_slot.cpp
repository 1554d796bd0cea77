// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/route/goal_slot.hpp"

#include <algorithm>

namespace swarm::agent {
namespace {

// Arrival: distance to the slot. Progress: a smaller gain does not count. Blocked: no progress for
// this time.
constexpr double kNear_m = 1.0;
constexpr double kProgress_m = 0.1;
constexpr Duration kBlockedAfter = std::chrono::seconds(2);
constexpr double kAtRest_m = 0.1;  // arrived robots this near to their slot rest
constexpr double kRim = 8.2;       // squared Mahalanobis distance; the 99 % ellipse is at 9.21

}  // namespace

GoalSlot::GoalSlot(const Gaussian& goal, const Vec2& slot_m, Shared<GoalSlotOptions> options)
    : options_(std::move(options)), goal_(goal), slot_m_(slot_m) {}

/// Arrival with hysteresis: within the rim to arrive, within the ellipse to stay arrived. Without
/// progress for 2 s a robot inside takes its position as its slot; one outside switches its aim
/// between slot and mean.
bool GoalSlot::has_arrived(SteadyTime now, const Vec2& position_m) {
  const bool inside = goal_.contains_99(position_m);
  if (arrived_) {
    if (!inside) nearest_m_ = std::numeric_limits<double>::infinity();
    return arrived_ = inside;
  }
  const double left_m = (aim_m() - position_m).norm();
  if (left_m < nearest_m_ - options_->scale * kProgress_m) {
    nearest_m_ = left_m;
    progress_at_ = now;
  }
  if (now - progress_at_ > kBlockedAfter) {
    if (inside) {
      slot_m_ = position_m;
      blocked_ = false;
    } else {
      blocked_ = !blocked_;
    }
    nearest_m_ = std::numeric_limits<double>::infinity();
  }
  // Within the rim only: between rim and ellipse other robots could push it out again.
  const bool well_inside = goal_.mahalanobis_squared(position_m) <= kRim;
  return arrived_ = well_inside && (slot_m_ - position_m).norm() < options_->scale * kNear_m;
}

/// The push u of goal_slot.hpp. O(close neighbours).
Vec2 GoalSlot::room(const ControlView& view) const {
  const double own = goal_.mahalanobis_squared(view.position_m);
  Vec2 push = Vec2::Zero();
  for (const Neighbour& n : view.close) {
    const Vec2 away_m = view.position_m - n.position_m;
    const double distance_m = away_m.norm();
    const double lacking_m = options_->radius_m + n.radius_m + options_->room_gap_m - distance_m;
    if (lacking_m <= 0.0 || distance_m < 1e-9) continue;
    const double its = goal_.mahalanobis_squared(n.position_m);
    const double share = its > kChiSquared2Dof99 ? options_->outside_share
                         : its > own             ? 1.0
                                                 : options_->inner_share;
    push += share * lacking_m / distance_m * away_m;
  }
  return options_->room_gain_hz * push;
}

/// While pushed the slot follows the robot, so it does not return to where it made room; without a
/// push it drives back to the slot.
Vec2 GoalSlot::keep(const ControlView& view) {
  Vec2 push = room(view);
  // Pushes may not drive the robot out of the goal: beyond the rim the outward part is removed, and
  // an inward velocity grows towards the edge.
  const double beyond_rim = goal_.mahalanobis_squared(view.position_m) - kRim;
  if (beyond_rim > 0.0) {
    const Vec2 inwards = (goal_.mean_m() - view.position_m).normalized();
    const double share = beyond_rim / (kChiSquared2Dof99 - kRim);
    push += (share * options_->approach_max_mps - std::min(0.0, push.dot(inwards))) * inwards;
  }
  if (push != Vec2::Zero()) {
    slot_m_ = view.position_m;
    return push;
  }
  const Vec2 path_m = slot_m_ - view.position_m;
  const double left_m = path_m.norm();
  if (left_m < options_->scale * kAtRest_m) return Vec2::Zero();
  const double speed = std::min(options_->approach_max_mps, options_->approach_gain_hz * left_m);
  return speed / left_m * path_m;
}

}  // namespace swarm::agent
