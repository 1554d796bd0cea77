// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/methods/crops/fields/obstacle_field.hpp"

#include <algorithm>

namespace swarm::agent {

/// The sum is over obstacles, not over the convex parts they are split into: only the nearest part
/// of each counts, or cutting an obstacle in two would double its force.
Vec2 obstacle_field(const Vec2& position_m, const World& world,
                    const ObstacleFieldOptions& options) {
  const std::vector<ConvexObstacle>& parts = world.convex_obstacles();
  const double reach_m = options.radius_m + options.reach_m;
  Vec2 sum = Vec2::Zero();
  SignedDistance nearest;  // of the obstacle the parts seen last belong to
  std::size_t obstacle = parts.size();
  const auto add = [&] {
    if (obstacle == parts.size()) return;
    const double gap_m = std::max(options.gap_min_m, nearest.distance_m - options.radius_m);
    // x − c_o is the unit gradient times the distance, here no less than the radius.
    const double potential = options.gain_m / (gap_m * gap_m);
    sum += nearest.gradient * std::max(nearest.distance_m, options.radius_m) * potential;
  };
  // In ascending order, so that the parts of an obstacle come one after the other.
  world.convex_boxes().for_each_within({position_m, position_m}, reach_m, [&](std::uint32_t i) {
    const SignedDistance sd = parts[i].signed_distance(position_m);
    if (sd.distance_m > reach_m) return;
    if (parts[i].obstacle != obstacle) {
      add();
      obstacle = parts[i].obstacle;
      nearest = sd;
    } else if (sd.distance_m < nearest.distance_m) {
      nearest = sd;
    }
  });
  add();
  return sum;
}

}  // namespace swarm::agent
