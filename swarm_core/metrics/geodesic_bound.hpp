// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm {

/// Largest number of robots for which the bound is the optimal assignment itself.
inline constexpr std::size_t kExactBoundRobots = 2000;

/// Mean over the robots of the optimal assignment between `starts` and `ends` with shortest
/// obstacle-avoiding paths as cost [m]. No controller on this map can have a shorter mean path. +∞
/// if no assignment exists.
///
/// Beyond kExactBoundRobots, robots near each other are moved to one of them first. By the triangle
/// inequality the optimal transport between these groups, less the mean distance to them, is still
/// a lower bound; it is lower by at most twice that distance. \pre starts.size() == ends.size();
/// asserted. 0 for no robots.
double geodesic_bound_m(const World& world, double robot_radius_m, std::span<const Vec2> starts,
                        std::span<const Vec2> ends);

}  // namespace swarm
