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

#include "planner_service/plan_limits.hpp"
#include "planner_service/plan_routes.hpp"
#include "planner_service/roadmap/edge_check.hpp"
#include "planner_service/roadmap/endpoints.hpp"
#include "planner_service/transport/capped_flow.hpp"
#include "planner_service/transport/route.hpp"
#include "planner_service/transport/shortcuts.hpp"
#include "planner_service/transport/shortest_routes.hpp"
#include "planner_service/transport/straighten.hpp"
#include "planner_service/transport/tighten.hpp"
#include "planner_service/transport/timed_flow.hpp"
#include "planner_service/transport/transport_lp.hpp"

namespace swarm::planner {
namespace {

// What a cap has to leave above the density of start and goal for mass to move at all.
constexpr double kAboveEnds = 1.05;

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
                               const PlannerOptions& options, const DensityCap& cap,
                               EdgeChecker& checker, StageTimer& stage, StageTimer& whole) {
  result.stats.cap_per_m2 = cap.max_per_m2;
  const std::vector<double> supplies = weights_of(request.start);
  const std::vector<double> demands = weights_of(request.goal);
  if (!options.density_is_timed) {
    const auto flow = capped_flow(result.roadmap, supplies, demands, cap, checker);
    if (!flow) return tl::unexpected(flow.error());
    result.stats.transport_ms = stage.lap_ms();
    return plan_of_routes(flow->routes, flow->routes, request, leg_speed(options),
                          std::move(result), whole);
  }
  auto flow =
      timed_flow(result.roadmap, supplies, demands, cap, {.speed = leg_speed(options)}, checker);
  if (!flow) return tl::unexpected(flow.error());
  result.stats.transport_ms += stage.lap_ms();
  const double raw_mean_path_m = mean_path_m(flow->plan);
  if (options.shortcuts > 0) {
    const StraightenOptions straight{.speed = leg_speed(options),
                                     .sigma_min_m = kSqueezeBelowMin * options.sampler.sigma_min_m};
    flow->plan =
        straighten(flow->plan, flow->is_end, request.world, options.risk, cap, straight, checker);
    result.stats.smoothing_ms += stage.lap_ms();
  }
  result = plan_of_flow(std::move(flow->plan), std::move(result), whole);
  result.stats.raw_mean_path_m = raw_mean_path_m;
  return result;
}

Result<PlanResult> plan_uncapped(PlanResult result, const PlanRequest& request,
                                 const PlannerOptions& options, EdgeChecker& checker, Rng& rng,
                                 StageTimer& stage, StageTimer& whole) {
  auto routes = choose_routes(result.roadmap, request, options, checker, stage, result.stats);
  if (!routes) return tl::unexpected(routes.error());
  const std::vector<Route> raw = *routes;
  if (options.shortcuts > 0) {
    for (Route& route : *routes) smooth(route.waypoints, request.world, options, checker, rng);
  }
  result.stats.smoothing_ms = stage.lap_ms();
  return plan_of_routes(raw, *routes, request, leg_speed(options), std::move(result), whole);
}

std::string in_one_line(std::string text) {
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos;) {
    text.replace(at, 1, "; ");
  }
  return text;
}

// The highest density of the start components together, or of the goal components.
double density_of_ends_per_m2(const PlanRequest& request, double robots) {
  double highest = 0.0;
  for (const Mixture* mixture : {&request.start, &request.goal}) {
    std::vector<Gaussian> components;
    for (const WeightedGaussian& c : mixture->components()) components.push_back(c.gaussian);
    highest = std::max(highest, max_density(components, weights_of(*mixture), robots).per_m2);
  }
  return highest;
}

// The plan under the cap of the bodies, where the uncapped one is denser than they can be. Start
// and goal stay as they are: where they are denser than the cap themselves it is raised to them.
PlanResult capped_where_needed(PlanResult uncapped, const PlanRequest& request,
                               const PlannerOptions& options, EdgeChecker& checker,
                               StageTimer& stage, StageTimer& whole) {
  const double robots = options.density.robots;
  if (densest_disc_of(uncapped.plan, robots).per_m2 <= options.limits.packing_per_m2) {
    return uncapped;
  }
  const double ends_per_m2 = kAboveEnds * density_of_ends_per_m2(request, robots);
  const DensityCap cap{std::max(options.limits.cap_per_m2, ends_per_m2), robots};
  PlanResult result;
  result.roadmap = uncapped.roadmap;
  result.stats = {.roadmap_ms = uncapped.stats.roadmap_ms,
                  .search_ms = uncapped.stats.search_ms,
                  .transport_ms = uncapped.stats.transport_ms,
                  .smoothing_ms = uncapped.stats.smoothing_ms,
                  .total_ms = uncapped.stats.total_ms};
  auto capped = plan_capped(std::move(result), request, options, cap, checker, stage, whole);
  if (!capped) {
    uncapped.warnings.push_back(
        {"cap-infeasible", fmt::format("planned without a density cap: {}",
                                       in_one_line(std::move(capped.error().message)))});
    return uncapped;
  }
  if (cap.max_per_m2 > options.limits.cap_per_m2) {
    capped->warnings.push_back(
        {"cap-raised", fmt::format("density capped at {:.1f} robots/m2, not at {:.1f}: the start "
                                   "or the goal is nearly as dense",
                                   cap.max_per_m2, options.limits.cap_per_m2)});
  }
  return *std::move(capped);
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
    return plan_capped(std::move(result), request, options, options.density, checker, stage, whole);
  }
  auto uncapped = plan_uncapped(std::move(result), request, options, checker, rng, stage, whole);
  if (!uncapped || !options.cap_is_automatic) return uncapped;
  return capped_where_needed(*std::move(uncapped), request, options, checker, stage, whole);
}

}  // namespace swarm::planner
