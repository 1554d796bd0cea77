// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/shared/route_plan.hpp"

#include "planner_service/flow/merge_routes.hpp"
#include "swarm_core/gmm/wasserstein.hpp"

namespace swarm::planner {

// A speed of 0 means that the bodies are not known: then robots do not limit the legs.
LegSpeed leg_speed(double speed_mps, const SwarmLimits& limits) {
  LegSpeed speed{.means_mps = speed_mps};
  if (limits.robot_speed_mps > 0.0) speed.robots_mps = limits.robot_speed_mps;
  return speed;
}

std::vector<Gaussian> terminals_of(const PlanRequest& request) {
  std::vector<Gaussian> terminals;
  for (const Mixture* mixture : {&request.start, &request.goal}) {
    for (const WeightedGaussian& component : mixture->components()) {
      terminals.push_back(component.gaussian);
    }
  }
  return terminals;
}

Result<FlowPlan> flow_of(std::span<const Route> routes, const PlanRequest& request,
                         const LegSpeed& speed) {
  return build_merged_plan(routes, request.start.components().size(),
                           request.goal.components().size(), speed);
}

// Mean path of a robot as the mass-weighted length of the means' paths.
double mean_path_m(const FlowPlan& flow) {
  double path_m = 0.0;
  for (const PlanLeg& leg : flow.legs()) {
    const Vec2& from_m = flow.nodes()[leg.from].gaussian.mean_m();
    path_m += leg.mass * (flow.nodes()[leg.to].gaussian.mean_m() - from_m).norm();
  }
  return path_m;
}

// The cost is Σ λᵢⱼ Lᵢⱼ of (13), with W₂ lengths; the paths count the means alone.
void measure_routes(PlanStats& stats, std::span<const Route> raw, std::span<const Route> routes) {
  for (const Route& route : raw) {
    stats.raw_mean_path_m += route.mass * mean_length_m(route.waypoints);
  }
  for (const Route& route : routes) {
    stats.planned_mean_path_m += route.mass * mean_length_m(route.waypoints);
    stats.cost_m += route.mass * w2_length_m(route.waypoints);
  }
}

// A flow has no routes before smoothing: raw and planned length are the same until the caller
// replaces the raw one.
void measure_flow(PlanStats& stats, const FlowPlan& flow) {
  stats.planned_mean_path_m = mean_path_m(flow);
  stats.raw_mean_path_m = stats.planned_mean_path_m;
  for (const PlanLeg& leg : flow.legs()) {
    const Gaussian& from = flow.nodes()[leg.from].gaussian;
    const Gaussian& to = flow.nodes()[leg.to].gaussian;
    stats.cost_m += leg.mass * wasserstein2(from, to);
  }
}

}  // namespace swarm::planner
