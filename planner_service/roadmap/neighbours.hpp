// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "swarm_core/gmm/gaussian.hpp"

namespace swarm::planner {

/// An unordered pair of roadmap nodes, a < b, and their W₂ distance.
struct NeighbourPair {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  double distance_m = 0.0;
};

/// NEIGHBOUR of SwarmPRM, Alg. 1, for all nodes at once: every pair with W₂ ≤ radius, ordered by
/// (a, b). W₂ is at least the distance of the means, so a k-d tree on these finds a superset.
std::vector<NeighbourPair> find_neighbours(std::span<const Gaussian> nodes, double radius_m);

}  // namespace swarm::planner
