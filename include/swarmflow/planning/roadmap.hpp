// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "swarmflow/core/gaussian.hpp"

namespace swarm::planner {

/// A graph of Gaussians with undirected edges that a method searched for routes. For SwarmPRM it is
/// the Gaussian roadmap G = (V, E) of [SwarmPRM, Alg. 1], whose nodes and edges (along W₂
/// geodesics) keep the risk limit. Each edge is stored as two arcs, grouped by their first node
/// (compressed sparse rows).
struct Roadmap {
  /// One direction of an edge.
  struct Arc {
    std::uint32_t to = 0;   ///< index into `nodes` of its other end
    double length_m = 0.0;  ///< W₂ of its ends [m], or the method's cost of the edge; +∞: closed
  };

  std::vector<Gaussian> nodes;            ///< the Gaussians, world frame
  std::vector<std::uint32_t> arc_offset;  ///< arcs of node i: [arc_offset[i], arc_offset[i + 1])
  std::vector<Arc> arcs;                  ///< two for every edge

  /// The arcs that leave a node. \pre node < nodes.size(), and arc_offset is filled in; not checked
  std::span<const Arc> arcs_of(std::uint32_t node) const {
    return std::span(arcs).subspan(arc_offset[node], arc_offset[node + 1] - arc_offset[node]);
  }
  /// Number of undirected edges, closed ones included.
  std::size_t edge_count() const { return arcs.size() / 2; }

  /// Closes the edge between two nodes for every later search: the length of both arcs becomes +∞.
  /// O(edges at the two nodes). Does nothing if there is no such edge.
  void close_edge(std::uint32_t a, std::uint32_t b);
};

}  // namespace swarm::planner
