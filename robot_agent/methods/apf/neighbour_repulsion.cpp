// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/methods/apf/neighbour_repulsion.hpp"

#include <algorithm>

namespace swarm::agent {

/// The sum of the pushes p (1 − gap/d₀), at most p each, also where bodies overlap.
[[gnu::hot]] Vec2 neighbour_repulsion(const Vec2& position_m, std::span<const Neighbour> neighbours,
                                      const NeighbourRepulsionOptions& options) {
  const double gap_m = std::max(options.gap_m, 1e-9);
  const double per_m = 1.0 / gap_m;
  Vec2 push = Vec2::Zero();
  for (const Neighbour& n : neighbours) {
    const Vec2 away = position_m - n.position_m;
    const double distance = away.norm();
    const double gap = distance - options.radius_m - n.radius_m;
    // Which neighbours are near is unpredictable: min and max, since std::clamp compiles to a
    // branch.
    const double strength = per_m * (gap_m - std::min(std::max(gap, 0.0), gap_m));
    push += strength / std::max(distance, 1e-9) * away;
  }
  return options.push_mps * push;
}

}  // namespace swarm::agent
