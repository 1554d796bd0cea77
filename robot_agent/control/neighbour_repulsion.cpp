// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/control/neighbour_repulsion.hpp"

#include <algorithm>

namespace swarm::agent {

Vec2 neighbour_repulsion(const Vec2& position_m, std::span<const Neighbour> neighbours,
                         const NeighbourRepulsionOptions& options) {
  const double per_m = 1.0 / std::max(options.gap_m, 1e-9);
  Vec2 push = Vec2::Zero();
  for (const Neighbour& n : neighbours) {
    const Vec2 away = position_m - n.position_m;
    const double distance = away.norm();
    const double gap = distance - options.radius_m - n.radius_m;
    // Who is near is a coin toss: no branch.
    const double strength = std::clamp(1.0 - per_m * gap, 0.0, 1.0);
    push += strength / std::max(distance, 1e-9) * away;
  }
  return options.push_mps * push;
}

}  // namespace swarm::agent
