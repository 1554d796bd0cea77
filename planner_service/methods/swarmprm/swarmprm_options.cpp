// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/swarmprm/swarmprm_options.hpp"

#include <algorithm>
#include <string_view>

namespace swarm::planner {
namespace {

SamplerKind sampler_named(std::string_view word) {
  if (word == "uniform") return SamplerKind::kUniform;
  return word == "halton" ? SamplerKind::kHalton : SamplerKind::kFit;
}

}  // namespace

SwarmPrmOptions swarmprm_options(const MethodContext& context) {
  const PlannerSpec& spec = context.mission.planner;
  SwarmPrmOptions options{.samples = spec.samples,
                          .connection_radius_m = spec.connection_radius_m,
                          .risk = {.alpha = spec.risk_alpha, .delta_m = spec.risk_delta_m},
                          .sampler = {.kind = sampler_named(spec.sampler),
                                      .sigma_min_m = spec.sigma_min_m,
                                      .sigma_max_m = spec.sigma_max_m,
                                      .rho_max = spec.rho_max,
                                      .bridge_share = spec.bridge_share,
                                      .bridge_sigma_m = spec.bridge_sigma_m},
                          .shortcuts = spec.shortcuts,
                          .speed_mps = spec.speed_mps,
                          .density = {.max_per_m2 = spec.density_cap_per_m2.value_or(0.0),
                                      .robots = static_cast<double>(context.mission.robots.count)},
                          .limits = context.limits,
                          .cap_is_automatic = !spec.density_cap_per_m2,
                          .density_is_timed = spec.density_cap == "timed",
                          .keeps_roadmap = context.use == PlanningUse::kInFlight};
  if (options.cap_is_automatic) {
    options.speed_mps = std::min(options.speed_mps, options.limits.plan_speed_mps);
  }
  return options;
}

}  // namespace swarm::planner
