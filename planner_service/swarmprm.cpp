// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/swarmprm.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "planner_service/plan_routes.hpp"
#include "planner_service/roadmap/edge_check.hpp"
#include "planner_service/roadmap/endpoints.hpp"
#include "planner_service/transport/capped_flow.hpp"
#include "planner_service/transport/route.hpp"
#include "planner_service/transport/shortcuts.hpp"
#include "planner_service/transport/shortest_routes.hpp"
#include "planner_service/transport/tighten.hpp"
#include "planner_service/transport/timed_flow.hpp"
#include "planner_service/transport/transport_lp.hpp"

namespace swarm::planner {
namespace {

std::vector<double> weights_of(const Mixture& mixture) {
  std::vector<double> weights;
  for (const WeightedGaussian& component : mixture.components())
    weights.push_back(component.weight);
  return weights;
}

Error no_route(std::span<const double> costs_m, std::size_t starts, std::size_t goals,
               const PlannerOptions& options) {
  std::string pairs;
  for (std::size_t i = 0; i < starts; ++i) {
    for (std::size_t j = 0; j < goals; ++j) {
      if (std::isfinite(costs_m[i * goals + j])) continue;
      pairs += fmt::format("{}{} -> {}", pairs.empty() ? "" : ", ", i, j);
    }
  }
  return {
      ErrorCode::kInfeasible,
      fmt::format("no route on the roadmap joins these start and goal components, and the swarm "
                  "cannot avoid them: {}; raise planner.samples ({}) or "
                  "planner.connection_radius_m ({}), lower planner.sigma_min_m ({}), or raise "
                  "planner.risk_alpha ({}) or planner.risk_delta_m ({})",
                  pairs, options.samples, options.connection_radius_m, options.sampler.sigma_min_m,
                  options.risk.alpha, options.risk.delta_m)};
}

// The routes of the cheapest transport, all of whose edges are proven. A closed edge is rare (an
// edge that breaks the limit by less than the roadmap's tolerance), so the search starts over.
Result<std::vector<Route>> choose_routes(Roadmap& roadmap, const PlanRequest& request,
                                         const PlannerOptions& options, EdgeChecker& checker,
                                         StageTimer& stage, PlanStats& stats) {
  const std::vector<double> supplies = weights_of(request.start);
  const std::vector<double> demands = weights_of(request.goal);
  const std::size_t starts = supplies.size();
  std::vector<std::uint32_t> start_nodes(starts);
  std::vector<std::uint32_t> goal_nodes(demands.size());
  std::iota(start_nodes.begin(), start_nodes.end(), 0U);
  std::iota(goal_nodes.begin(), goal_nodes.end(), static_cast<std::uint32_t>(starts));
  for (;;) {
    const RouteTable table(roadmap, start_nodes, goal_nodes);
    std::vector<double> costs_m;
    for (std::size_t i = 0; i < starts; ++i) {
      for (std::size_t j = 0; j < demands.size(); ++j) costs_m.push_back(table.length_m(i, j));
    }
    stats.search_ms += stage.lap_ms();
    const auto shipments = solve_transport(supplies, demands, costs_m);
    stats.transport_ms += stage.lap_ms();
    if (!shipments) {
      return tl::unexpected(no_route(costs_m, starts, demands.size(), options));
    }
    std::vector<Route> routes;
    bool proven = true;
    for (const Shipment& shipment : *shipments) {
      const std::vector<std::uint32_t> nodes = table.nodes(shipment.from, shipment.to);
      Route route{shipment.from, shipment.to, shipment.mass, {}};
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        route.waypoints.push_back(roadmap.nodes[nodes[i]]);
        if (i == 0 ||
            checker.is_free(route.waypoints[i - 1], route.waypoints[i], kPlanTolerance_m)) {
          continue;
        }
        roadmap.close_edge(nodes[i - 1], nodes[i]);
        proven = false;
      }
      routes.push_back(std::move(route));
    }
    stats.search_ms += stage.lap_ms();
    if (proven) return routes;
  }
}

void smooth(Waypoints& waypoints, const World& world, const PlannerOptions& options,
            EdgeChecker& checker, Rng& rng) {
  take_shortcuts(waypoints, options.shortcuts, checker, rng);
  const TightenOptions band{.sigma_min_m = kSqueezeBelowMin * options.sampler.sigma_min_m};
  tighten(waypoints, world, options.risk, band, checker);
  drop_superfluous(waypoints, checker);
}

// The flow under a density cap, node by node or time by time.
Result<PlanResult> plan_capped(PlanResult result, const PlanRequest& request,
                               const PlannerOptions& options, EdgeChecker& checker,
                               StageTimer& stage, StageTimer& whole) {
  const std::vector<double> supplies = weights_of(request.start);
  const std::vector<double> demands = weights_of(request.goal);
  if (!options.density_is_timed) {
    const auto flow = capped_flow(result.roadmap, supplies, demands, options.density, checker);
    if (!flow) return tl::unexpected(flow.error());
    result.stats.transport_ms = stage.lap_ms();
    return plan_of_routes(flow->routes, flow->routes, request, {options.speed_mps},
                          std::move(result), whole);
  }
  auto flow = timed_flow(result.roadmap, supplies, demands, options.density,
                         {.speed = {options.speed_mps}}, checker);
  if (!flow) return tl::unexpected(flow.error());
  result.stats.transport_ms = stage.lap_ms();
  return plan_of_flow(std::move(flow->plan), std::move(result), whole);
}

}  // namespace

std::vector<Gaussian> terminals_of(const PlanRequest& request) {
  std::vector<Gaussian> terminals;
  for (const Mixture* mixture : {&request.start, &request.goal}) {
    for (const WeightedGaussian& component : mixture->components()) {
      terminals.push_back(component.gaussian);
    }
  }
  return terminals;
}

Result<void> check_endpoints(const PlanRequest& request, const RiskLimit& risk) {
  std::string violations = describe_violations(request.start, "start", request.world, risk);
  const std::string at_goal = describe_violations(request.goal, "goal", request.world, risk);
  if (!violations.empty() && !at_goal.empty()) violations += '\n';
  violations += at_goal;
  if (violations.empty()) return {};
  return fail(ErrorCode::kInfeasible, std::move(violations));
}

Roadmap make_roadmap(const PlanRequest& request, const PlannerOptions& options, Rng& rng) {
  std::vector<Gaussian> nodes = terminals_of(request);
  const std::size_t terminals = nodes.size();
  const std::vector<Gaussian> samples =
      sample_free(request.world, options.risk, options.sampler, options.samples, rng);
  nodes.insert(nodes.end(), samples.begin(), samples.end());
  EdgeChecker checker(request.world, options.risk);
  return connect(std::move(nodes), options.connection_radius_m, checker, terminals);
}

Result<PlanResult> plan_on_roadmap(Roadmap roadmap, const PlanRequest& request,
                                   const PlannerOptions& options, Rng& rng, StageTimer& stage,
                                   StageTimer& whole) {
  PlanResult result;
  result.roadmap = std::move(roadmap);
  result.stats.roadmap_ms = stage.lap_ms();
  EdgeChecker checker(request.world, options.risk);
  if (options.density.max_per_m2 > 0.0) {
    return plan_capped(std::move(result), request, options, checker, stage, whole);
  }
  auto routes = choose_routes(result.roadmap, request, options, checker, stage, result.stats);
  if (!routes) return tl::unexpected(routes.error());
  const std::vector<Route> raw = *routes;
  if (options.shortcuts > 0) {
    for (Route& route : *routes) smooth(route.waypoints, request.world, options, checker, rng);
  }
  result.stats.smoothing_ms = stage.lap_ms();
  return plan_of_routes(raw, *routes, request, {options.speed_mps}, std::move(result), whole);
}

}  // namespace swarm::planner
