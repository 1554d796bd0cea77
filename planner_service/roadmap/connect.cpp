// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/connect.hpp"

#include <cstdint>
#include <utility>

namespace swarm::planner {

// Compressed rows by counting sort: degrees, their prefix sums, then each edge at both of its ends.
Roadmap assemble(std::vector<Gaussian> nodes, std::span<const NeighbourPair> edges) {
  Roadmap roadmap;
  roadmap.arc_offset.assign(nodes.size() + 1, 0);
  for (const NeighbourPair& edge : edges) {
    ++roadmap.arc_offset[edge.a + 1];
    ++roadmap.arc_offset[edge.b + 1];
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    roadmap.arc_offset[i + 1] += roadmap.arc_offset[i];
  }
  roadmap.arcs.resize(2 * edges.size());
  std::vector<std::uint32_t> fill(roadmap.arc_offset.begin(), roadmap.arc_offset.end() - 1);
  for (const NeighbourPair& edge : edges) {
    roadmap.arcs[fill[edge.a]++] = {edge.b, edge.distance_m};
    roadmap.arcs[fill[edge.b]++] = {edge.a, edge.distance_m};
  }
  roadmap.nodes = std::move(nodes);
  return roadmap;
}

// Edge ends are shared by all edges of a node, so that the distances to obstacles are computed
// once.
Roadmap connect(std::vector<Gaussian> nodes, double radius_m, EdgeChecker& checker,
                std::size_t terminals) {
  std::vector<NeighbourPair> edges = find_neighbours(nodes, radius_m, terminals);
  std::vector<EdgeEnd> ends(nodes.begin(), nodes.end());
  std::erase_if(edges, [&](const NeighbourPair& edge) {
    return !checker.is_free(ends[edge.a], ends[edge.b], kBuildTolerance_m);
  });
  return assemble(std::move(nodes), edges);
}

}  // namespace swarm::planner
