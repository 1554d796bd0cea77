// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "robot_agent/neighbours/silent_robots.hpp"
#include "swarmflow/robot/neighbour.hpp"

namespace swarm::agent {

struct NeighbourOptions;

/// The discs of silent robots within reach of one robot, as neighbours: at the centre of the disc
/// and with its radius, and while the disc grows, its surface approaches. Their information does
/// not age.
struct SilentNeighbours {
  std::vector<Neighbour> close, far;
  /// The robot is within a disc and stands (see SilentRobots); it retreats from no other, and the
  /// lists are empty.
  bool is_within = false;

  void clear() {
    close.clear();
    far.clear();
    is_within = false;
  }
};

/// Finds them for a robot at `own_position_m`. The lists of `found` are buffers; it does not
/// allocate once warm. O(silent robots).
void find_silent_neighbours(const SilentRobots& robots, const NeighbourOptions& options,
                            const Vec2& own_position_m, SilentNeighbours& found);

}  // namespace swarm::agent
