// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/control/neighbour_repulsion.hpp"

#include <algorithm>

namespace swarm::agent {

Vec2 neighbour_repulsion(const Vec2& position_m, std::span<const Neighbour> neighbours,
                         const NeighbourRepulsionOptions& options) {
  Vec2 push = Vec2::Zero();
  for (const Neighbour& n : neighbours) {
    const Vec2 away = position_m - n.position_m;
    const double distance = away.norm();
    const double gap = distance - options.radius_m - n.radius_m;
    if (gap >= options.gap_m || distance < 1e-9) continue;
    const double strength = std::min(1.0, 1.0 - gap / options.gap_m);
    push += options.push_mps * strength / distance * away;
  }
  return push;
}

}  // namespace swarm::agent
