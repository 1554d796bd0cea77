// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "swarmflow/core/gaussian.hpp"

namespace swarm::planner {

/// A graph of Gaussians with undirected edges: what a method searched. For SwarmPRM the Gaussian
/// roadmap G = (V, E) of Alg. 1, whose nodes keep the risk limit and whose edges, along W₂
/// geodesics, do too. Edges are stored in both directions, grouped by node (CSR).
struct Roadmap {
  struct Arc {
    std::uint32_t to = 0;
    double length_m = 0.0;  ///< W₂, or the method's cost of the edge
  };

  std::vector<Gaussian> nodes;
  std::vector<std::uint32_t> arc_offset;  ///< nodes.size() + 1 entries
  std::vector<Arc> arcs;

  /// The edges at a node, by the node at their other end.
  std::span<const Arc> arcs_of(std::uint32_t node) const {
    return std::span(arcs).subspan(arc_offset[node], arc_offset[node + 1] - arc_offset[node]);
  }
  std::size_t edge_count() const { return arcs.size() / 2; }

  /// Closes the edge between two nodes for every later search: its length becomes +∞.
  void close_edge(std::uint32_t a, std::uint32_t b);
};

}  // namespace swarm::planner
