// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/planner.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "planner_service/roadmap/edge_check.hpp"
#include "planner_service/roadmap/endpoints.hpp"
#include "planner_service/transport/build_plan.hpp"
#include "planner_service/transport/route.hpp"
#include "planner_service/transport/shortcuts.hpp"
#include "planner_service/transport/shortest_routes.hpp"
#include "planner_service/transport/tighten.hpp"
#include "planner_service/transport/transport_lp.hpp"
#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {
namespace {

constexpr int kFineGrid = 200;

// Takes the time between calls.
class StageTimer {
 public:
  explicit StageTimer(const StageClock& clock) : clock_(clock), last_(clock()) {}
  double lap_ms() {
    const SteadyTime now = clock_();
    const double lap_ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return lap_ms;
  }

 private:
  const StageClock& clock_;
  SteadyTime last_;
};

std::vector<double> weights_of(const Mixture& mixture) {
  std::vector<double> weights;
  for (const WeightedGaussian& component : mixture.components())
    weights.push_back(component.weight);
  return weights;
}

Result<void> check_endpoints(const PlanRequest& request, const RiskLimit& risk) {
  std::string violations = describe_violations(request.start, "start", request.world, risk);
  const std::string at_goal = describe_violations(request.goal, "goal", request.world, risk);
  if (!violations.empty() && !at_goal.empty()) violations += '\n';
  violations += at_goal;
  if (violations.empty()) return {};
  return fail(ErrorCode::kInfeasible, std::move(violations));
}

std::vector<Gaussian> roadmap_nodes(const PlanRequest& request, const PlannerOptions& options,
                                    Rng& rng) {
  std::vector<Gaussian> nodes;
  for (const Mixture* mixture : {&request.start, &request.goal}) {
    for (const WeightedGaussian& component : mixture->components()) {
      nodes.push_back(component.gaussian);
    }
  }
  const std::vector<Gaussian> samples =
      sample_free(request.world, options.risk, options.sampler, options.samples, rng);
  nodes.insert(nodes.end(), samples.begin(), samples.end());
  return nodes;
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
  std::vector<std::uint32_t> goal_nodes(demands.size());
  std::iota(goal_nodes.begin(), goal_nodes.end(), static_cast<std::uint32_t>(starts));
  for (;;) {
    std::vector<ShortestRoutes> searches;
    std::vector<double> costs_m;
    for (std::uint32_t i = 0; i < starts; ++i) {
      searches.emplace_back(roadmap, i, goal_nodes);
      for (const std::uint32_t goal : goal_nodes) costs_m.push_back(searches[i].length_m(goal));
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
      const std::vector<std::uint32_t> nodes =
          searches[shipment.from].nodes_to(goal_nodes[shipment.to]);
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

}  // namespace

PlannerOptions planner_options(const PlannerSpec& spec) {
  return {.samples = spec.samples,
          .connection_radius_m = spec.connection_radius_m,
          .risk = {.alpha = spec.risk_alpha, .delta_m = spec.risk_delta_m},
          .sampler = {.kind = spec.sampler == "uniform" ? SamplerKind::kUniform : SamplerKind::kFit,
                      .sigma_min_m = spec.sigma_min_m,
                      .sigma_max_m = spec.sigma_max_m,
                      .rho_max = spec.rho_max,
                      .bridge_share = spec.bridge_share,
                      .bridge_sigma_m = spec.bridge_sigma_m},
          .shortcuts = spec.shortcuts,
          .speed_mps = spec.speed_mps};
}

Result<PlanResult> plan(const PlanRequest& request, const PlannerOptions& options, Rng& rng,
                        const StageClock& clock) {
  StageTimer whole(clock);
  StageTimer stage(clock);
  if (auto checked = check_endpoints(request, options.risk); !checked) {
    return tl::unexpected(checked.error());
  }
  const std::size_t starts = request.start.components().size();
  const std::size_t goals = request.goal.components().size();
  PlanResult result;
  EdgeChecker checker(request.world, options.risk);
  result.roadmap = connect(roadmap_nodes(request, options, rng), options.connection_radius_m,
                           checker, starts + goals);
  result.stats.nodes = result.roadmap.nodes.size();
  result.stats.edges = result.roadmap.edge_count();
  result.stats.roadmap_ms = stage.lap_ms();

  auto routes = choose_routes(result.roadmap, request, options, checker, stage, result.stats);
  if (!routes) return tl::unexpected(routes.error());

  for (Route& route : *routes) {
    result.stats.raw_mean_path_m += route.mass * mean_length_m(route.waypoints);
    if (options.shortcuts > 0) smooth(route.waypoints, request.world, options, checker, rng);
    result.stats.planned_mean_path_m += route.mass * mean_length_m(route.waypoints);
    result.stats.cost_m += route.mass * w2_length_m(route.waypoints);
  }
  Result<FlowPlan> flow = build_plan(*routes, starts, goals, options.speed_mps);
  if (!flow) return tl::unexpected(flow.error());
  result.plan = *std::move(flow);
  result.stats.smoothing_ms = stage.lap_ms();
  result.stats.total_ms = whole.lap_ms();
  return result;
}

double planned_max_cvar_m(const FlowPlan& plan, const World& world, double alpha) {
  const double k = cvar_coefficient(alpha);
  double worst_m = -std::numeric_limits<double>::infinity();
  for (const PlanNode& node : plan.nodes()) {
    worst_m = std::max(worst_m, max_cvar_m(node.gaussian, world, k));
  }
  for (const PlanLeg& leg : plan.legs()) {
    const Geodesic geodesic(plan.nodes()[leg.from].gaussian, plan.nodes()[leg.to].gaussian);
    for (int i = 1; i < kFineGrid; ++i) {
      const Gaussian g = geodesic.at(static_cast<double>(i) / kFineGrid);
      worst_m = std::max(worst_m, max_cvar_m(g, world, k));
    }
  }
  return worst_m;
}

double planned_obstacle_share(const FlowPlan& plan, const World& world, std::size_t samples,
                              Rng& rng) {
  constexpr std::size_t kTimes = 100;
  const std::size_t points = std::max<std::size_t>(1, samples / kTimes);
  double worst = 0.0;
  for (std::size_t i = 0; i < kTimes; ++i) {
    const double share = static_cast<double>(i) / (kTimes - 1);
    const Mixture mixture = plan.mixture_at(share * plan.duration());
    std::size_t inside = 0;
    for (std::size_t p = 0; p < points; ++p) {
      const std::size_t component =
          mixture.component_at((static_cast<double>(p) + 0.5) / static_cast<double>(points));
      const Gaussian& g = mixture.components()[component].gaussian;
      const double u = standard_normal(rng);
      const Vec2 z(u, standard_normal(rng));
      inside += world.is_clear(g.mean_m() + cholesky_lower(g.covariance_m2()) * z, 0.0) ? 0U : 1U;
    }
    worst = std::max(worst, static_cast<double>(inside) / static_cast<double>(points));
  }
  return worst;
}

}  // namespace swarm::planner
