// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "robot_agent/methods/builtin_methods.hpp"
#include "robot_agent/methods/diffusion/intermittent_diffusion.hpp"
#include "robot_agent/methods/diffusion/intermittent_diffusion_keys.hpp"

namespace swarm::agent {
IntermittentDiffusionOptions intermittent_diffusion_options(const Mission& mission,
                                                            const BodySpec& body) {
  const auto c = intermittent_diffusion_keys().read(mission.control.options);
  return {
      .shape = mission.goal_shape,
      .goal = mission.goal,
      .repulsion = {.strength_m2 = c.strength_m2, .range_m = c.range_or_default_m(body.radius_m)},
      .diffusion = {.noise_mps05 = c.noise_mps05,
                    .time_s = c.time_s,
                    .clearance_m = body.radius_m + mission.safety.obstacle_margin_m},
      .obstacles = {.radius_m = body.radius_m,
                    .gap_m = c.obstacle_gap_m,
                    .push_mps = c.obstacle_push_mps},
      .radius_m = body.radius_m,
      .tolerance_m2 = c.tolerance_m2,
      .gain_hz = c.gain_hz,
      .cruise_mps = std::min(mission.control.cruise_mps, body.speed_max_mps),
      .period = from_seconds(1.0 / mission.control.rate_hz),
      .flow_time = from_seconds(c.flow_s)};
}

namespace {

/// Leaves the reach infinite: the virtual diffusion reads all neighbours.
Result<PreparedControl> prepare_diffusion(const ControlContext& context) {
  const Shared<IntermittentDiffusionOptions> options =
      intermittent_diffusion_options(context.mission, context.body);
  return PreparedControl{
      .make = [options] { return ControlSlot::of<IntermittentDiffusion>(options); }};
}

}  // namespace

ControlEntry intermittent_diffusion_method() {
  return {.spec = {.name = "intermittent_diffusion",
                   .doc = "Shape formation by gradient flow and intermittent diffusion, without a "
                          "path [intermittent diffusion, Alg. 1]",
                   .options = intermittent_diffusion_keys().specs(),
                   .shape_tolerance = "diffusion_tolerance_m2"},
          .prepare = prepare_diffusion};
}

}  // namespace swarm::agent
