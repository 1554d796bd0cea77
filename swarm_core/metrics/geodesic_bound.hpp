// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "swarm_core/base/linalg.hpp"
#include "swarm_core/world/world.hpp"

namespace swarm {

/// Shortest obstacle-avoiding distances between points, obstacles grown by the robot's radius
/// (visibility graph). Grown corners and circles are arcs approximated by *inscribed* chords, so every
/// distance is a lower bound of the true one, tight to a few millimetres per corner.
class ShortestPaths {
 public:
  ShortestPaths(const World& world, double robot_radius_m);

  /// Matrix [from.size() × to.size()], row-major [m]; +∞ where no way exists. A point inside a grown
  /// obstacle may leave it freely (the bound stays a bound).
  std::vector<double> distances_m(std::span<const Vec2> from, std::span<const Vec2> to) const;

 private:
  bool visible(const Vec2& a, const Vec2& b) const;

  std::vector<std::vector<Vec2>> grown_;  // convex, counter-clockwise
  std::vector<Vec2> vertices_;
  std::vector<double> vertex_distances_;  // all pairs, row-major
};

/// Cost of the cheapest one-to-one assignment of n rows to n columns (network simplex).
/// \pre costs.size() == n*n, all finite and ≥ 0
double assignment_cost(std::span<const double> costs, std::size_t n);

/// Mean over the robots of the optimal assignment between `starts` and `ends` with shortest
/// obstacle-avoiding paths as cost [m]. No controller on this map can have a shorter mean path.
double geodesic_bound_m(const World& world, double robot_radius_m, std::span<const Vec2> starts,
                        std::span<const Vec2> ends);

}  // namespace swarm
