// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/swarmprm/swarmprm.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "planner_service/flow/capped_flow.hpp"
#include "planner_service/flow/plan_density.hpp"
#include "planner_service/flow/route.hpp"
#include "planner_service/flow/shortcuts.hpp"
#include "planner_service/flow/shortest_routes.hpp"
#include "planner_service/flow/straighten.hpp"
#include "planner_service/flow/tighten.hpp"
#include "planner_service/flow/timed_flow.hpp"
#include "planner_service/flow/transport_lp.hpp"
#include "planner_service/methods/shared/route_plan.hpp"
#include "planner_service/roadmap/connect.hpp"
#include "planner_service/roadmap/edge_check.hpp"
#include "swarm_core/base/one_line.hpp"

namespace swarm::planner {
namespace {

// Ratio of a cap to the density of start and goal that leaves room for mass to move at all.
constexpr double kAboveEnds = 1.05;

// The highest density of the start components together, or of the goal components.
double density_of_ends_per_m2(const PlanRequest& request, double robots) {
  double highest = 0.0;
  for (const Mixture* mixture : {&request.start, &request.goal}) {
    std::vector<Gaussian> components;
    for (const WeightedGaussian& c : mixture->components()) components.push_back(c.gaussian);
    const std::vector<double> weights = weights_of(mixture->components());
    highest = std::max(highest, max_density(components, weights, robots).per_m2);
  }
  return highest;
}

// A plan while it is made: the data that its stages share.
class PlanInProgress {
 public:
  PlanInProgress(const PlanRequest& request, const SwarmPrmOptions& options, const SwarmPrmRun& run)
      : request_(request),
        options_(options),
        run_(run),
        speed_(leg_speed(options.speed_mps, options.limits)),
        supplies_(weights_of(request.start.components())),
        demands_(weights_of(request.goal.components())),
        checker_(request.world, options.risk, options.limits.length_scale) {}

  Result<PlanResult> capped(PlanResult result, const DensityCap& cap);
  Result<PlanResult> uncapped(PlanResult result);
  PlanResult capped_where_needed(PlanResult uncapped);

 private:
  Error no_route(std::span<const double> costs_m) const;
  std::optional<std::vector<Route>> proven_routes(const RouteTable& table,
                                                  std::span<const Shipment> shipments,
                                                  Roadmap& roadmap);
  Result<std::vector<Route>> choose_routes(Roadmap& roadmap, PlanStats& stats);
  void smooth(Waypoints& waypoints);

  const PlanRequest& request_;
  const SwarmPrmOptions& options_;
  SwarmPrmRun run_;
  LegSpeed speed_;
  std::vector<double> supplies_;
  std::vector<double> demands_;
  EdgeChecker checker_;
};

Error PlanInProgress::no_route(std::span<const double> costs_m) const {
  return {
      ErrorCode::kInfeasible,
      fmt::format("no route on the roadmap joins these start and goal components, and the swarm "
                  "cannot avoid them: {}; raise planner.samples ({}) or "
                  "planner.connection_radius_m ({}), lower planner.sigma_min_m ({}), or raise "
                  "planner.risk_alpha ({}) or planner.risk_delta_m ({})",
                  unjoined_pairs(costs_m, demands_.size()), options_.samples,
                  options_.connection_radius_m, options_.sampler.sigma_min_m, options_.risk.alpha,
                  options_.risk.delta_m)};
}

// The routes of the shipments; nothing where one of their edges breaks the risk limit by less than
// the roadmap's tolerance. Such edges are closed.
std::optional<std::vector<Route>> PlanInProgress::proven_routes(const RouteTable& table,
                                                                std::span<const Shipment> shipments,
                                                                Roadmap& roadmap) {
  std::vector<Route> routes;
  bool proven = true;
  for (const Shipment& shipment : shipments) {
    const std::vector<std::uint32_t> nodes = table.nodes(shipment.from, shipment.to);
    Route route{shipment.from, shipment.to, shipment.mass, {}};
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      route.waypoints.push_back(roadmap.nodes[nodes[i]]);
      if (i == 0 ||
          checker_.is_free(route.waypoints[i - 1], route.waypoints[i], kPlanTolerance_m)) {
        continue;
      }
      roadmap.close_edge(nodes[i - 1], nodes[i]);
      proven = false;
    }
    routes.push_back(std::move(route));
  }
  if (!proven) return std::nullopt;
  return routes;
}

// The routes of the cheapest transport, all of whose edges are proven. A closed edge is rare, so
// the search starts over.
Result<std::vector<Route>> PlanInProgress::choose_routes(Roadmap& roadmap, PlanStats& stats) {
  std::vector<std::uint32_t> start_nodes(supplies_.size());
  std::vector<std::uint32_t> goal_nodes(demands_.size());
  std::iota(start_nodes.begin(), start_nodes.end(), 0U);
  std::iota(goal_nodes.begin(), goal_nodes.end(), static_cast<std::uint32_t>(supplies_.size()));
  for (;;) {
    const RouteTable table(roadmap, start_nodes, goal_nodes);
    std::vector<double> costs_m;
    for (std::size_t i = 0; i < start_nodes.size(); ++i) {
      for (std::size_t j = 0; j < goal_nodes.size(); ++j) costs_m.push_back(table.length_m(i, j));
    }
    stats.search_ms += run_.stage.lap_ms();
    const auto shipments = solve_transport(supplies_, demands_, costs_m);
    stats.transport_ms += run_.stage.lap_ms();
    if (!shipments) return tl::unexpected(no_route(costs_m));
    auto routes = proven_routes(table, *shipments, roadmap);
    stats.search_ms += run_.stage.lap_ms();
    if (routes) return *std::move(routes);
  }
}

// Shortcuts remove large detours, tightening pulls the rest straight around corners, and waypoints
// that tightening added without need are dropped last.
void PlanInProgress::smooth(Waypoints& waypoints) {
  take_shortcuts(waypoints, options_.shortcuts, checker_, run_.rng);
  const TightenOptions band{.spacing_m = options_.limits.length_scale * TightenOptions{}.spacing_m,
                            .sigma_min_m = kSqueezeBelowMin * options_.sampler.sigma_min_m};
  tighten(waypoints, request_.world, options_.risk, band, checker_);
  drop_superfluous(waypoints, checker_);
}

// The flow under a density cap: mass counted at each node over all time (static), or at each node
// and time (timed). A static flow is not smoothed: smoothing would move mass away from the nodes
// whose capacities bound it.
Result<PlanResult> PlanInProgress::capped(PlanResult result, const DensityCap& cap) {
  result.stats.cap_per_m2 = cap.max_per_m2;
  if (!options_.density_is_timed) {
    const auto by_node = capped_flow(result.roadmap, supplies_, demands_, cap, checker_);
    if (!by_node) return tl::unexpected(by_node.error());
    result.stats.transport_ms = run_.stage.lap_ms();
    auto plan = flow_of(by_node->routes, request_, speed_);
    if (!plan) return tl::unexpected(plan.error());
    result.plan = *std::move(plan);
    measure_routes(result.stats, by_node->routes, by_node->routes);
    return result;
  }
  result.stats.cap_is_timed = true;
  auto flow = timed_flow(result.roadmap, supplies_, demands_, cap, {.speed = speed_}, checker_);
  if (!flow) return tl::unexpected(flow.error());
  result.stats.transport_ms += run_.stage.lap_ms();
  const double raw_mean_path_m = mean_path_m(flow->plan);
  if (options_.shortcuts > 0) {
    const StraightenOptions straight{
        .speed = speed_,
        .sigma_min_m = kSqueezeBelowMin * options_.sampler.sigma_min_m,
        .split_m = options_.limits.length_scale * StraightenOptions{}.split_m};
    flow->plan = straighten(flow->plan, flow->is_end, request_.world, options_.risk, cap, straight,
                            checker_);
    result.stats.smoothing_ms += run_.stage.lap_ms();
  }
  measure_flow(result.stats, flow->plan);
  result.stats.raw_mean_path_m = raw_mean_path_m;
  result.plan = std::move(flow->plan);
  return result;
}

// Alg. 2 without a cap: routes, smoothing, merged flow.
Result<PlanResult> PlanInProgress::uncapped(PlanResult result) {
  auto routes = choose_routes(result.roadmap, result.stats);
  if (!routes) return tl::unexpected(routes.error());
  const std::vector<Route> raw = *routes;
  if (options_.shortcuts > 0) {
    for (Route& route : *routes) smooth(route.waypoints);
  }
  result.stats.smoothing_ms = run_.stage.lap_ms();
  auto plan = flow_of(*routes, request_, speed_);
  if (!plan) return tl::unexpected(plan.error());
  result.plan = *std::move(plan);
  measure_routes(result.stats, raw, *routes);
  return result;
}

// Plans again under the cap of the bodies where the uncapped plan is denser than bodies can be
// packed. Start and goal are given: where they are denser than the cap, the cap is raised above
// them. If the capped plan fails the uncapped one is returned with a warning.
PlanResult PlanInProgress::capped_where_needed(PlanResult uncapped) {
  const double robots = options_.density.robots;
  if (densest_disc_of(uncapped.plan, robots, options_.limits.length_scale).per_m2 <=
      options_.limits.packing_per_m2) {
    return uncapped;
  }
  const double ends_per_m2 = kAboveEnds * density_of_ends_per_m2(request_, robots);
  const DensityCap cap{std::max(options_.limits.cap_per_m2, ends_per_m2), robots};
  PlanResult begun;
  begun.roadmap = uncapped.roadmap;
  begun.stats = {.roadmap_ms = uncapped.stats.roadmap_ms,
                 .search_ms = uncapped.stats.search_ms,
                 .transport_ms = uncapped.stats.transport_ms,
                 .smoothing_ms = uncapped.stats.smoothing_ms};
  auto result = capped(std::move(begun), cap);
  if (!result) {
    uncapped.warnings.push_back(
        {"cap-infeasible", fmt::format("planned without a density cap: {}",
                                       one_line(std::move(result.error().message)))});
    return uncapped;
  }
  if (cap.max_per_m2 > options_.limits.cap_per_m2) {
    result->warnings.push_back(
        {"cap-raised", fmt::format("density capped at {:.1f} robots/m2, not at {:.1f}: the start "
                                   "or the goal is nearly as dense",
                                   cap.max_per_m2, options_.limits.cap_per_m2)});
  }
  return *std::move(result);
}

}  // namespace

// Start and goal components come first, the samples after them.
Roadmap make_roadmap(const PlanRequest& request, const SwarmPrmOptions& options, Rng& rng) {
  std::vector<Gaussian> nodes = terminals_of(request);
  const std::size_t terminals = nodes.size();
  const std::vector<Gaussian> samples =
      sample_free(request.world, options.risk, options.sampler, options.samples, rng);
  nodes.insert(nodes.end(), samples.begin(), samples.end());
  EdgeChecker checker(request.world, options.risk, options.limits.length_scale);
  return connect(std::move(nodes), options.connection_radius_m, checker, terminals);
}

Result<PlanResult> plan_on_roadmap(Roadmap roadmap, const PlanRequest& request,
                                   const SwarmPrmOptions& options, const SwarmPrmRun& run) {
  PlanResult result;
  result.roadmap = std::move(roadmap);
  result.stats.roadmap_ms = run.stage.lap_ms();
  PlanInProgress plan(request, options, run);
  if (options.density.max_per_m2 > 0.0) return plan.capped(std::move(result), options.density);
  auto uncapped = plan.uncapped(std::move(result));
  if (!uncapped || !options.cap_is_automatic) return uncapped;
  return plan.capped_where_needed(*std::move(uncapped));
}

}  // namespace swarm::planner
