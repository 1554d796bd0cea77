// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/swarmprm/swarmprm_options.hpp"

#include <algorithm>
#include <string_view>

#include "planner_service/methods/swarmprm/swarmprm_keys.hpp"

namespace swarm::planner {
namespace {

// The key has been validated: any other name is "fit".
SamplerKind sampler_named(std::string_view name) {
  if (name == "uniform") return SamplerKind::kUniform;
  return name == "halton" ? SamplerKind::kHalton : SamplerKind::kFit;
}

}  // namespace

// A roadmap is kept only for missions in flight, where obstacles may change; the speed is lowered
// to that of the bodies where the cap is chosen automatically.
SwarmPrmOptions swarmprm_options(const MethodContext& context) {
  const PlannerSpec& spec = context.mission.planner;
  const SwarmPrmKeys keys = swarmprm_keys().read(context.options());
  SwarmPrmOptions options{.samples = keys.samples,
                          .connection_radius_m = keys.connection_radius_m,
                          .risk = {.alpha = spec.risk_alpha, .delta_m = spec.risk_delta_m},
                          .sampler = {.kind = sampler_named(keys.sampler),
                                      .sigma_min_m = keys.sigma_min_m,
                                      .sigma_max_m = keys.sigma_max_m,
                                      .rho_max = keys.rho_max,
                                      .bridge_share = keys.bridge_share,
                                      .bridge_sigma_m = keys.bridge_sigma_m},
                          .shortcuts = keys.shortcuts,
                          .speed_mps = spec.speed_mps,
                          .density = {.max_per_m2 = spec.density_cap_per_m2.value_or(0.0),
                                      .robots = static_cast<double>(context.mission.robots.count)},
                          .limits = context.limits,
                          .cap_is_automatic = !spec.density_cap_per_m2,
                          .density_is_timed = keys.density_cap == "timed",
                          .keeps_roadmap = context.use == PlanningUse::kInFlight};
  if (options.cap_is_automatic) {
    options.speed_mps = std::min(options.speed_mps, options.limits.plan_speed_mps);
  }
  return options;
}

}  // namespace swarm::planner
