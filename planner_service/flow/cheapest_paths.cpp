// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/cheapest_paths.hpp"

#include <numeric>

#include "planner_service/flow/shortest_routes.hpp"

namespace swarm::planner {

// One search per start, each ended when the lengths to all goals are known; then (13) on the
// lengths.
PathTransport transport_on_paths(const Roadmap& roadmap, std::span<const double> supplies,
                                 std::span<const double> demands) {
  std::vector<std::uint32_t> goal_nodes(demands.size());
  std::iota(goal_nodes.begin(), goal_nodes.end(), static_cast<std::uint32_t>(supplies.size()));
  std::vector<ShortestRoutes> searches;
  PathTransport result;
  for (std::uint32_t i = 0; i < supplies.size(); ++i) {
    searches.emplace_back(roadmap, i, goal_nodes);
    for (const std::uint32_t goal : goal_nodes) result.costs.push_back(searches[i].length_m(goal));
  }
  const auto shipments = solve_transport(supplies, demands, result.costs);
  if (!shipments) return result;
  for (const Shipment& shipment : *shipments) {
    result.paths.push_back({shipment, searches[shipment.from].nodes_to(goal_nodes[shipment.to])});
  }
  return result;
}

}  // namespace swarm::planner
