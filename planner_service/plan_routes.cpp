// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/plan_routes.hpp"

#include <utility>

#include "planner_service/transport/build_plan.hpp"

namespace swarm::planner {

Result<PlanResult> plan_of_routes(std::span<const Route> raw, std::span<const Route> routes,
                                  const PlanRequest& request, double speed_mps, PlanResult result,
                                  StageTimer& whole) {
  PlanStats& stats = result.stats;
  for (const Route& route : raw) {
    stats.raw_mean_path_m += route.mass * mean_length_m(route.waypoints);
  }
  for (const Route& route : routes) {
    stats.planned_mean_path_m += route.mass * mean_length_m(route.waypoints);
    stats.cost_m += route.mass * w2_length_m(route.waypoints);
  }
  Result<FlowPlan> flow = build_plan(routes, request.start.components().size(),
                                     request.goal.components().size(), speed_mps);
  if (!flow) return tl::unexpected(flow.error());
  result.plan = *std::move(flow);
  stats.nodes = result.roadmap.nodes.size();
  stats.edges = result.roadmap.edge_count();
  stats.total_ms = whole.lap_ms();
  return result;
}

}  // namespace swarm::planner
