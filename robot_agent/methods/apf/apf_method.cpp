// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>

#include "robot_agent/methods/apf/apf.hpp"
#include "robot_agent/methods/builtin_methods.hpp"
#include "robot_agent/methods/shared/shared_keys.hpp"
#include "swarm_core/mission/body_scale.hpp"

namespace swarm::agent {
namespace {

/// The keys of a mission's control section that apf reads.
struct ApfKeys : PathKeys, ObstacleKeys {
  std::string tracking = "plan";
  double pace_gain_hz = 0.3;
  double keep_clearance_m = 1.0;
  double density_push_mps = 0.0;
  double neighbour_gap_m = 1.0;
  double neighbour_push_mps = 0.6;
  double escape_spread_m = 4.0;
};

const OptionTable<ApfKeys>& apf_keys() {
  static const auto table =
      OptionTable<ApfKeys>()
          .choice(
              "tracking", &ApfKeys::tracking, {"plan", "free"},
              "plan: keep the plan's times; free: travel the planned path at the robot's own speed")
          .with(path_keys())
          .number("pace_gain_hz", &ApfKeys::pace_gain_hz, between(0, 100),
                  "tracking plan: speed per metre behind the reference position")
          .number("keep_clearance_m", &ApfKeys::keep_clearance_m, between(0, 100),
                  "shortcuts keep the planned clearance up to this distance")
          .number("density_push_mps", &ApfKeys::density_push_mps, between(0, 100),
                  "largest speed towards the planned density; 0: off")
          .number("neighbour_gap_m", &ApfKeys::neighbour_gap_m, between(0, 100),
                  "d0: neighbours nearer than this push")
          .number("neighbour_push_mps", &ApfKeys::neighbour_push_mps, between(0, 100),
                  "speed of that push at contact")
          .with(obstacle_keys())
          .number("escape_spread_m", &ApfKeys::escape_spread_m, between(0, 1000),
                  "largest standard deviation per axis of the positions to escape to");
  return table;
}

/// Translates keys, mission and body into options. No robot cruises faster than its body can.
ApfOptions apf_options(const ApfKeys& c, const Mission& mission, const BodySpec& body) {
  const double cruise_mps = std::min(mission.control.cruise_mps, body.speed_max_mps);
  const double scale = length_scale(body);
  return {.keeps_time = c.tracking == "plan",
          .pursuit = {.look_ahead_m = c.look_ahead_s * cruise_mps,
                      .radius_m = body.radius_m,
                      .passed_m = scale * PursuitOptions{}.passed_m,
                      .keep_clearance_m = c.keep_clearance_m,
                      .scale = scale},
          .pace = {.look_ahead_s = c.look_ahead_s,
                   .gain_hz = c.pace_gain_hz,
                   .approach_gain_hz = c.approach_gain_hz,
                   .cruise_mps = cruise_mps},
          .density = {.push_mps = c.density_push_mps,
                      .kernel_m = scale * DensityAttractionOptions{}.kernel_m},
          .neighbour_repulsion = {.radius_m = body.radius_m,
                                  .gap_m = c.neighbour_gap_m,
                                  .push_mps = c.neighbour_push_mps},
          .obstacle_repulsion = {.radius_m = body.radius_m,
                                 .gap_m = c.obstacle_gap_m,
                                 .push_mps = c.obstacle_push_mps},
          .escape = {.progress_m = scale * EscapeOptions{}.progress_m,
                     .stuck_after = from_seconds(c.stuck_after_s),
                     .duration = from_seconds(c.escape_s),
                     .spread_m = c.escape_spread_m,
                     .radius_m = body.radius_m},
          .scale = scale};
}

/// The reach covers every neighbour that a term depends on: d₀ of the repulsion between surfaces,
/// and the kernel of the density estimate between centres.
Result<PreparedControl> prepare_apf(const ControlContext& context) {
  const ApfKeys keys = apf_keys().read(context.options());
  const double bodies_m = context.body.radius_m + largest_radius_m(context.mission.robots);
  const bool reads_density = keys.density_push_mps > 0.0;
  const Shared<ApfOptions> options = apf_options(keys, context.mission, context.body);
  const double kernel_m = reads_density ? options->density.kernel_m : 0.0;
  return PreparedControl{.make = [options] { return ControlSlot::of<Apf>(options); },
                         .reach_m = std::max(bodies_m + keys.neighbour_gap_m, kernel_m),
                         .press_gap_m = keys.neighbour_gap_m,
                         .reads_density = reads_density};
}

}  // namespace

ControlEntry apf_method() {
  return {.spec = {.name = "apf",
                   .doc = "Artificial potential field along the robot's path through the plan "
                          "[SwarmPRM, eq. 14]",
                   .options = apf_keys().specs()},
          .prepare = prepare_apf};
}

}  // namespace swarm::agent
