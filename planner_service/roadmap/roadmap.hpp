// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner_service/roadmap/edge_check.hpp"
#include "planner_service/roadmap/neighbours.hpp"
#include "swarm_core/gmm/gaussian.hpp"

namespace swarm::planner {

/// Edges of the roadmap are proven to keep CVaR ≤ δ + this. Coarse, because thousands are built and
/// a dozen used: those are proven again to kPlanTolerance_m. Proving all of them costs ten times as
/// much.
inline constexpr double kBuildTolerance_m = 0.1;

/// What a plan promises: CVaR ≤ δ + this on every leg.
inline constexpr double kPlanTolerance_m = 1e-3;

/// The Gaussian roadmap G = (V, E) of SwarmPRM, Alg. 1: nodes that keep the risk limit and
/// undirected edges along W₂ geodesics that do. Edges are stored in both directions, grouped by
/// node (CSR).
struct Roadmap {
  struct Arc {
    std::uint32_t to = 0;
    double length_m = 0.0;  ///< W₂
  };

  std::vector<Gaussian> nodes;
  std::vector<std::uint32_t> arc_offset;  ///< nodes.size() + 1 entries
  std::vector<Arc> arcs;

  std::span<const Arc> arcs_of(std::uint32_t node) const {
    return std::span(arcs).subspan(arc_offset[node], arc_offset[node + 1] - arc_offset[node]);
  }
  std::size_t edge_count() const { return arcs.size() / 2; }

  /// Closes the edge between two nodes for every later search: its length becomes +∞.
  void close_edge(std::uint32_t a, std::uint32_t b);
};

/// The roadmap of these edges, each given once; a node's arcs are in the order of the edges.
Roadmap assemble(std::vector<Gaussian> nodes, std::span<const NeighbourPair> edges);

/// ROADMAPCONSTRUCTION without the sampling: joins all nodes within W₂ ≤ radius whose geodesic is
/// free; `terminals` as in find_neighbours().
Roadmap connect(std::vector<Gaussian> nodes, double radius_m, EdgeChecker& checker,
                std::size_t terminals = 0);

}  // namespace swarm::planner
