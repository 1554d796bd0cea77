// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/metrics/geodesic_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "swarm_core/base/assert.hpp"
#include "swarm_core/metrics/assignment.hpp"
#include "swarm_core/metrics/shortest_paths.hpp"

namespace swarm {
namespace {

/// Cost of a pair without a path: more than the sum of all path lengths in any realistic world.
constexpr double kNoPath_m = 1e8;

/// Groups of points, each of which has one of its points as its centre.
struct Groups {
  std::vector<Vec2> centers_m;
  std::vector<std::int64_t> sizes;
  double moved_m = 0.0;  // sum of the distances from the points to their centres
};

using Indices = std::span<std::size_t>;

/// Splits at the median of the wider axis until groups have at most `most` points.
void gather(std::span<const Vec2> points, Indices indices, std::size_t most,
            const ShortestPaths& paths, Groups& groups) {
  const auto at = [&](std::size_t i) -> const Vec2& { return points[indices[i]]; };
  const std::size_t half = indices.size() / 2;
  Vec2 low = at(0);
  Vec2 high = at(0);
  for (const std::size_t i : indices) {
    low = low.cwiseMin(points[i]);
    high = high.cwiseMax(points[i]);
  }
  const Eigen::Index axis = high.x() - low.x() >= high.y() - low.y() ? 0 : 1;
  std::nth_element(indices.begin(), indices.begin() + static_cast<std::ptrdiff_t>(half),
                   indices.end(),
                   [&](std::size_t a, std::size_t b) { return points[a][axis] < points[b][axis]; });
  if (indices.size() > most) {
    gather(points, indices.first(half), most, paths, groups);
    gather(points, indices.subspan(half), most, paths, groups);
    return;
  }
  const Vec2 center = at(half);
  std::vector<Vec2> members;
  for (const std::size_t i : indices) members.push_back(points[i]);
  for (const double d : paths.distances_m(std::span(&center, 1), members)) groups.moved_m += d;
  groups.centers_m.push_back(center);
  groups.sizes.push_back(static_cast<std::int64_t>(indices.size()));
}

/// Groups of one point each while there are at most kExactBoundRobots points: the bound is then the
/// exact assignment.
Groups groups_of(std::span<const Vec2> points, const ShortestPaths& paths) {
  const std::size_t most = (points.size() + kExactBoundRobots - 1) / kExactBoundRobots;
  Groups groups;
  if (most <= 1) {
    groups.centers_m.assign(points.begin(), points.end());
    groups.sizes.assign(points.size(), 1);
    return groups;
  }
  std::vector<std::size_t> indices(points.size());
  std::iota(indices.begin(), indices.end(), 0);
  // Halving ends with groups between half of the limit and the limit: a limit of 2·most − 1 keeps
  // the number of groups near kExactBoundRobots.
  gather(points, indices, 2 * most - 1, paths, groups);
  return groups;
}

}  // namespace

/// W₁ with geodesic costs. Moving points to their centres changes the total by at most the sum of
/// the moved distances, which is subtracted: the result stays a lower bound.
double geodesic_bound_m(const World& world, double robot_radius_m, std::span<const Vec2> starts,
                        std::span<const Vec2> ends) {
  SWARM_ASSERT(starts.size() == ends.size());
  if (starts.empty()) return 0.0;
  const ShortestPaths paths(world, robot_radius_m);
  const Groups from = groups_of(starts, paths);
  const Groups to = groups_of(ends, paths);
  std::vector<double> costs = paths.distances_m(from.centers_m, to.centers_m);
  // An infinite cost would break the integer simplex; a large finite one shows in the total
  // instead.
  bool all_paths_exist = true;
  for (double& cost : costs) {
    all_paths_exist = all_paths_exist && cost <= kNoPath_m;
    cost = std::min(cost, kNoPath_m);
  }
  const double total = transport_cost(costs, from.sizes, to.sizes);
  if (!all_paths_exist && total >= kNoPath_m) return std::numeric_limits<double>::infinity();
  const double n = static_cast<double>(starts.size());
  return std::max(0.0, (total - from.moved_m - to.moved_m) / n);
}

}  // namespace swarm
