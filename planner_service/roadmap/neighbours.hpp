// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "swarmflow/core/gaussian.hpp"

namespace swarm::planner {

/// An unordered pair of roadmap nodes, a < b, and their W₂ distance.
struct NeighbourPair {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  double distance_m = 0.0;
};

/// NEIGHBOUR of SwarmPRM, Alg. 1, for all nodes at once: every pair with W₂ ≤ radius, ordered by
/// (a, b). W₂ is at least the distance of the means, so a k-d tree of these finds a superset.
///
/// The first `terminals` nodes, the start and goal components, may be wider than any sample and
/// then farther than a small radius from all of them, however many there are: they reach at least
/// twice as far as to their nearest sample.
std::vector<NeighbourPair> find_neighbours(std::span<const Gaussian> nodes, double radius_m,
                                           std::size_t terminals = 0);

/// The pairs of one of the terminals with the nodes after it, of those find_neighbours() finds.
std::vector<NeighbourPair> terminal_neighbours(std::span<const Gaussian> nodes,
                                               std::uint32_t terminal, std::size_t terminals,
                                               double radius_m);

}  // namespace swarm::planner
