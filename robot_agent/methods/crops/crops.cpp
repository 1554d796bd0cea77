// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/methods/crops/crops.hpp"

#include <algorithm>
#include <array>

#include "robot_agent/methods/apf/neighbour_repulsion.hpp"
#include "robot_agent/methods/apf/obstacle_repulsion.hpp"
#include "robot_agent/methods/crops/fields/superposition.hpp"

namespace swarm::agent {
namespace {

constexpr double kLastSteps_m = 0.25;  // nearer, the approach does not slow down any further

}  // namespace

void Crops::begin(const Route& route, const World&) {
  sink_ = route.sink;
  guide_ = GuidePoints(route.path, options_.part(&CropsOptions::guide));
  slot_ = GoalSlot(route.goal, guide_.end_m(), options_.part(&CropsOptions::slot));
  remaining_m_ = route.path.length_m();
  escape_.forget();
}

bool Crops::has_arrived(const ControlView& view) {
  return slot_.has_arrived(view.now, view.position_m);
}

/// The superposition of the fields towards the present intermediate goal. Its length scales the
/// speed only below full_strength: where fields cancel the robot slows down.
Vec2 Crops::desired_velocity(const ControlView& view, bool arrived, Rng& rng) {
  const Vec2& x = view.position_m;
  if (arrived) {
    remaining_m_ = slot_.left_m(x);
    escape_.forget();
    return slot_.keep(view);
  }
  const Vec2 point_m = guide_.update(x, view.world, slot_.is_in_goal(x));
  const bool at_end = guide_.is_last();
  const Vec2 aim_m = at_end ? slot_.aim_m() : point_m;
  remaining_m_ = at_end ? slot_.left_m(x) : guide_.remaining_m(x);
  // Arrived robots make room in a full goal only for one that presses, so separation is off near
  // it. Where the robot is blocked all the same, it no longer gives way either: the robots nearer
  // to the goal have arrived.
  const bool into_goal = at_end || slot_.is_in_goal(point_m);
  const bool is_blocked = into_goal && slot_.is_blocked();
  const bool presses = is_blocked || (into_goal && slot_.is_beside(x));
  const Vec2 escape = escape_.update(x, rng);
  // A stuck robot may go near walls, as in the paper's code; the safety filter keeps it off them.
  const double wall_share = escape_.is_stuck() ? options_->stuck_wall_share : 1.0;
  const std::array<Vec2, 6> fields{
      wall_share * obstacle_field(x, view.world, options_->obstacle),
      presses ? Vec2(Vec2::Zero()) : separation_field(x, view.neighbours, options_->separation),
      is_blocked ? Vec2(Vec2::Zero()) : give_way_field(x, aim_m, view.close, options_->give_way),
      goal_field(x, aim_m, options_->goal),
      heading_field(x, view.neighbours, options_->heading),
      escape};
  const Vec2 sum = superposition(fields);
  const double strength = sum.norm();
  double speed_mps = options_->cruise_mps;
  if (at_end) {
    const double left_m = std::max(options_->guide.scale * kLastSteps_m, (aim_m - x).norm());
    speed_mps = std::min(speed_mps, options_->approach_gain_hz * left_m);
  }
  return speed_mps / std::max(strength, options_->full_strength) * sum;
}

/// A held robot gives way to neighbours by the repulsion of apf. The time does not count as stuck
/// or blocked.
Vec2 Crops::hold(const ControlView& view) {
  escape_.forget();
  slot_.wait(view.now);
  const double scale = options_->guide.scale;
  const NeighbourRepulsionOptions neighbours;
  const ObstacleRepulsionOptions obstacle;
  return neighbour_repulsion(view.position_m, view.close,
                             {.radius_m = options_->guide.radius_m,
                              .gap_m = scale * neighbours.gap_m,
                              .push_mps = scale * neighbours.push_mps}) +
         obstacle_repulsion(view.position_m, view.world,
                            {.radius_m = options_->guide.radius_m,
                             .gap_m = scale * obstacle.gap_m,
                             .push_mps = scale * obstacle.push_mps});
}

}  // namespace swarm::agent
