// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/swarmprm/swarmprm_method.hpp"

#include <utility>

#include "planner_service/methods/shared/route_plan.hpp"
#include "planner_service/methods/swarmprm/swarmprm.hpp"
#include "planner_service/methods/swarmprm/swarmprm_keys.hpp"
#include "planner_service/roadmap/endpoints.hpp"
#include "planner_service/stage_timer.hpp"

namespace swarm::planner {

Result<std::unique_ptr<PlanningMethod>> SwarmPrmMethod::make(const MethodContext& context) {
  return std::make_unique<SwarmPrmMethod>(swarmprm_options(context));
}

const std::vector<OptionSpec>& SwarmPrmMethod::keys() { return swarmprm_keys().specs(); }

PlanningTraits SwarmPrmMethod::traits() const {
  PlanningTraits traits{.risk_promise = RiskPromise::kEveryGaussian,
                        .is_kept_in_time = true,
                        .speed_mps = options_.speed_mps};
  if (options_.density.max_per_m2 > 0.0) {
    traits.density_cap_per_m2 = options_.density.max_per_m2;
  } else if (options_.cap_is_automatic) {
    traits.density_cap_per_m2 = options_.limits.cap_per_m2;
  }
  return traits;
}

// A roadmap for the request: a new one for a single plan, else the kept one, repaired where the
// world or the ends changed.
Roadmap SwarmPrmMethod::roadmap_for(const PlanRequest& request, Rng& rng) {
  if (!options_.keeps_roadmap) return make_roadmap(request, options_, rng);
  if (live_) {
    live_->update(request.world, terminals_of(request), rng);
  } else {
    const LiveRoadmapOptions wanted{.samples = options_.samples,
                                    .connection_radius_m = options_.connection_radius_m,
                                    .risk = options_.risk,
                                    .sampler = options_.sampler,
                                    .scale = options_.limits.length_scale};
    live_.emplace(request.world, terminals_of(request), wanted, rng);
  }
  return live_->roadmap();
}

// Ends are checked first: an error there is clearer than a roadmap that does not reach them.
Result<PlanResult> SwarmPrmMethod::plan(const PlanRequest& request, const PlanContext& context) {
  StageTimer stage(context.clock);
  const auto checked = check_endpoints(request.world, request.start, request.goal, options_.risk);
  if (!checked) return tl::unexpected(checked.error());
  return plan_on_roadmap(roadmap_for(request, context.rng), request, options_,
                         {context.rng, stage});
}

// Nodes and edges depend on the risk limit: the roadmap is sampled again.
void SwarmPrmMethod::set_risk(const RiskLimit& risk) {
  options_.risk = risk;
  live_.reset();
}

}  // namespace swarm::planner
