// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/adoc/adoc_method.hpp"

#include <utility>

#include "planner_service/methods/shared/route_plan.hpp"
#include "planner_service/methods/shared/shared_keys.hpp"
#include "planner_service/stage_timer.hpp"

namespace swarm::planner {

namespace {

/// Options of adoc in a mission.
struct AdocKeys : CollocationKeys {
  double penalty = 20.0;
};

const OptionTable<AdocKeys>& adoc_keys() {
  static const auto table =
      OptionTable<AdocKeys>()
          .with(collocation_keys())
          .number("adoc_penalty", &AdocKeys::penalty, between(0, 1e6),
                  "penalty on the share of a Gaussian that lies in obstacles");
  return table;
}

}  // namespace

const std::vector<OptionSpec>& AdocMethod::keys() { return adoc_keys().specs(); }

AdocOptions adoc_options(const Mission& mission) {
  const AdocKeys keys = adoc_keys().read(mission.planner.options);
  return {
      .collocation = {.spacing_m = keys.collocation_spacing_m, .sigma_m = keys.collocation_sigma_m},
      .transport_radius_m = keys.transport_radius_m,
      .penalty = keys.penalty};
}

AdocMethod::AdocMethod(const AdocOptions& options, const RiskLimit& risk, const LegSpeed& speed)
    : options_(options), risk_(risk), speed_(speed) {}

Result<std::unique_ptr<PlanningMethod>> AdocMethod::make(const MethodContext& context) {
  const PlannerSpec& spec = context.mission.planner;
  return std::make_unique<AdocMethod>(
      adoc_options(context.mission),
      RiskLimit{.alpha = spec.risk_alpha, .delta_m = spec.risk_delta_m},
      leg_speed(spec.speed_mps, context.limits));
}

// Routes follow the collocation set; they are neither smoothed nor tested against the risk limit.
Result<PlanResult> AdocMethod::plan(const PlanRequest& request, const PlanContext& context) {
  StageTimer stage(context.clock);
  const auto routes = adoc_routes(request.world, request.start, request.goal, options_);
  if (!routes) return tl::unexpected(routes.error());
  PlanResult result;
  result.stats.search_ms = stage.lap_ms();
  auto flow = flow_of(*routes, request, speed_);
  if (!flow) return tl::unexpected(flow.error());
  result.plan = *std::move(flow);
  measure_routes(result.stats, *routes, *routes);
  return result;
}

}  // namespace swarm::planner
