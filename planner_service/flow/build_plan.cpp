// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/build_plan.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

// Earliest time at each waypoint of a route that starts at 0.
std::vector<double> arrival_times_s(const Waypoints& waypoints, const LegSpeed& speed) {
  std::vector<double> times_s{0.0};
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    times_s.push_back(times_s.back() + route_leg_duration_s(waypoints, i, speed));
  }
  return times_s;
}

}  // namespace

// First pass: times, and the slowest route of each sink. Second pass: nodes and legs, with the
// times of each route stretched so that it arrives with the slowest.
Result<FlowPlan> build_plan(std::span<const Route> routes, std::size_t starts, std::size_t goals,
                            const LegSpeed& speed) {
  SWARM_ASSERT(speed.means_mps > 0.0 && speed.robots_mps > 0.0);
  std::vector<PlanNode> nodes(starts + goals);
  std::vector<std::vector<double>> times_s;
  for (const Route& route : routes) {
    SWARM_ASSERT(route.waypoints.size() >= 2 && route.from < starts && route.to < goals);
    times_s.push_back(arrival_times_s(route.waypoints, speed));
    PlanNode& source = nodes[route.from];
    PlanNode& sink = nodes[starts + route.to];
    source.gaussian = route.waypoints.front();
    source.mass += route.mass;
    sink.gaussian = route.waypoints.back();
    sink.mass += route.mass;
    sink.time = std::max(sink.time, MissionTime(times_s.back().back()));
  }
  std::vector<PlanLeg> legs;
  for (std::size_t r = 0; r < routes.size(); ++r) {
    const Route& route = routes[r];
    const auto sink = static_cast<std::uint32_t>(starts + route.to);
    const double stretch = nodes[sink].time.count() / times_s[r].back();
    auto previous = static_cast<std::uint32_t>(route.from);
    for (std::size_t i = 1; i + 1 < route.waypoints.size(); ++i) {
      const auto node = static_cast<std::uint32_t>(nodes.size());
      nodes.push_back({route.waypoints[i], MissionTime(stretch * times_s[r][i]), route.mass});
      legs.push_back({previous, node, route.mass});
      previous = node;
    }
    legs.push_back({previous, sink, route.mass});
  }
  return FlowPlan::make(std::move(nodes), std::move(legs));
}

}  // namespace swarm::planner
