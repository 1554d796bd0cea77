// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/plan_routes.hpp"

#include <utility>

#include "planner_service/transport/merge_routes.hpp"
#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {

LegSpeed leg_speed(const PlannerOptions& options) {
  LegSpeed speed{.means_mps = options.speed_mps};
  if (options.limits.robot_speed_mps > 0.0) speed.robots_mps = options.limits.robot_speed_mps;
  return speed;
}

double mean_path_m(const FlowPlan& flow) {
  double path_m = 0.0;
  for (const PlanLeg& leg : flow.legs()) {
    const Vec2& from_m = flow.nodes()[leg.from].gaussian.mean_m();
    path_m += leg.mass * (flow.nodes()[leg.to].gaussian.mean_m() - from_m).norm();
  }
  return path_m;
}

Result<PlanResult> plan_of_routes(std::span<const Route> raw, std::span<const Route> routes,
                                  const PlanRequest& request, const LegSpeed& speed,
                                  PlanResult result, StageTimer& whole) {
  PlanStats& stats = result.stats;
  for (const Route& route : raw) {
    stats.raw_mean_path_m += route.mass * mean_length_m(route.waypoints);
  }
  for (const Route& route : routes) {
    stats.planned_mean_path_m += route.mass * mean_length_m(route.waypoints);
    stats.cost_m += route.mass * w2_length_m(route.waypoints);
  }
  Result<FlowPlan> flow = build_merged_plan(routes, request.start.components().size(),
                                            request.goal.components().size(), speed);
  if (!flow) return tl::unexpected(flow.error());
  result.plan = *std::move(flow);
  stats.nodes = result.roadmap.nodes.size();
  stats.edges = result.roadmap.edge_count();
  stats.total_ms += whole.lap_ms();
  return result;
}

PlanResult plan_of_flow(FlowPlan flow, PlanResult result, StageTimer& whole) {
  PlanStats& stats = result.stats;
  stats.planned_mean_path_m = mean_path_m(flow);
  for (const PlanLeg& leg : flow.legs()) {
    const Gaussian& from = flow.nodes()[leg.from].gaussian;
    const Gaussian& to = flow.nodes()[leg.to].gaussian;
    stats.cost_m += leg.mass * wasserstein2(from, to);
  }
  stats.raw_mean_path_m = stats.planned_mean_path_m;
  result.plan = std::move(flow);
  stats.nodes = result.roadmap.nodes.size();
  stats.edges = result.roadmap.edge_count();
  stats.total_ms += whole.lap_ms();
  return result;
}

}  // namespace swarm::planner
