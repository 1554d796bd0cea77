// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "robot_agent/margins.hpp"
#include "robot_agent/methods/builtin_methods.hpp"
#include "robot_agent/methods/crops/crops.hpp"
#include "robot_agent/methods/shared/shared_keys.hpp"
#include "swarm_core/mission/body_scale.hpp"

namespace swarm::agent {
namespace {

/// The radius of intermediate goals: a key of the planner, which makes the guide.
double goal_radius_m(const Mission& mission) {
  return mission.planner.options.number("crops_goal_radius_m")
      .value_or(GuidePointsOptions{}.goal_radius_m);
}

/// The fields, whose lengths are those of the paper's robots, for robots of another size.
void scale_fields(CropsOptions& options, double scale) {
  options.obstacle.reach_m *= scale;
  options.obstacle.gain_m *= scale;
  options.obstacle.gap_min_m *= scale;
  options.separation.reach_m *= scale;
  options.separation.steepness_per_m /= scale;
  options.separation.gain_per_m /= scale;
  options.goal.steepness_per_m /= scale;
  options.heading.mean_m *= scale;
  options.heading.sigma_m *= scale;
  options.heading.moving_mps *= scale;
  options.escape.moved_min_m *= scale;
}

/// Times of the mission become ticks, since the stuck test counts positions.
CropsOptions crops_options(const Mission& mission, const BodySpec& body) {
  const PathKeys c = path_keys().read(mission.control.options);
  const double cruise_mps = std::min(mission.control.cruise_mps, body.speed_max_mps);
  const auto ticks = [&](double time_s) {
    return static_cast<std::size_t>(std::max(1.0, std::round(time_s * mission.control.rate_hz)));
  };
  const double scale = length_scale(body);
  CropsOptions options{
      .cruise_mps = cruise_mps,
      .approach_gain_hz = c.approach_gain_hz,
      .guide = {.radius_m = body.radius_m,
                .passable_m = obstacle_margin_m(mission, body) + scale * 0.01,
                .goal_radius_m = goal_radius_m(mission),
                .clearance_m = scale * GuidePointsOptions{}.clearance_m,
                .sight_m = c.look_ahead_s * cruise_mps,
                .scale = scale},
      .slot = {.radius_m = body.radius_m,
               .room_gap_m = room_gap_m(mission, body),
               .approach_gain_hz = c.approach_gain_hz,
               .approach_max_mps = scale * GoalSlotOptions{}.approach_max_mps,
               .scale = scale},
      .obstacle = {.radius_m = body.radius_m},
      .give_way = {.radius_m = body.radius_m,
                   .gap_m = mission.safety.neighbour_margin_m + scale * 0.1},
      .escape = {.window = ticks(c.stuck_after_s), .step = ticks(c.escape_s)},
  };
  scale_fields(options, scale);
  return options;
}

/// Of the fields that read all neighbours: separation and headings.
double reach_m(const CropsOptions& options) {
  constexpr double kSigmas = 2.5;  // farther headings weigh less than 5 %
  return std::max(options.separation.reach_m,
                  options.heading.mean_m + kSigmas * options.heading.sigma_m);
}

Result<PreparedControl> prepare_crops(const ControlContext& context) {
  const Shared<CropsOptions> options = crops_options(context.mission, context.body);
  return PreparedControl{.make = [options] { return ControlSlot::of<Crops>(options); },
                         .reach_m = reach_m(*options)};
}

}  // namespace

ControlEntry crops_method() {
  return {.spec = {.name = "crops",
                   .doc = "From one intermediate goal of the guide to the next in the direction of "
                          "superposed fields [CRoPS]",
                   .options = path_keys().specs()},
          .prepare = prepare_crops};
}

}  // namespace swarm::agent
