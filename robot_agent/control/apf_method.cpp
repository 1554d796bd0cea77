// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "robot_agent/control/apf.hpp"
#include "robot_agent/control/builtin_methods.hpp"

namespace swarm::agent {
namespace {

ApfOptions apf_options(const Mission& mission, const BodySpec& body) {
  const ControlSpec& c = mission.control;
  const double cruise_mps = std::min(c.cruise_mps, body.speed_max_mps);
  return {.keeps_time = c.tracking == "plan",
          .pursuit = {.look_ahead_m = c.look_ahead_s * cruise_mps,
                      .radius_m = body.radius_m,
                      .keep_clearance_m = c.keep_clearance_m},
          .pace = {.look_ahead_s = c.look_ahead_s,
                   .gain_hz = c.pace_gain_hz,
                   .approach_gain_hz = c.approach_gain_hz,
                   .cruise_mps = cruise_mps},
          .density = {.push_mps = c.density_push_mps},
          .neighbour_repulsion = {.radius_m = body.radius_m,
                                  .gap_m = c.neighbour_gap_m,
                                  .push_mps = c.neighbour_push_mps},
          .obstacle_repulsion = {.radius_m = body.radius_m,
                                 .gap_m = c.obstacle_gap_m,
                                 .push_mps = c.obstacle_push_mps},
          .escape = {.stuck_after = from_seconds(c.stuck_after_s),
                     .duration = from_seconds(c.escape_s),
                     .spread_m = c.escape_spread_m,
                     .radius_m = body.radius_m}};
}

Result<PreparedControl> prepare(const ControlContext& context) {
  const ControlSpec& control = context.mission.control;
  const double bodies_m = context.body.radius_m + largest_radius_m(context.mission.robots);
  const bool reads_density = control.density_push_mps > 0.0;
  const double kernel_m = reads_density ? DensityAttractionOptions{}.kernel_m : 0.0;
  const Shared<ApfOptions> options = apf_options(context.mission, context.body);
  return PreparedControl{.make = [options] { return ControlSlot::of<Apf>(options); },
                         .reach_m = std::max(bodies_m + control.neighbour_gap_m, kernel_m),
                         .reads_density = reads_density};
}

}  // namespace

ControlEntry apf_method() {
  return {.spec = {.name = "apf",
                   .doc = "Artificial potential field along the robot's path through the plan "
                          "[SwarmPRM, eq. 14]",
                   .options = {}},
          .prepare = prepare};
}

}  // namespace swarm::agent
