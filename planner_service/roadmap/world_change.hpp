// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarmflow/core/world.hpp"

namespace swarm::planner {

/// Where two worlds differ: the boxes of the convex obstacles that only one of them has. An
/// obstacle that moved is in both lists.
struct WorldChange {
  std::vector<Box> added;
  std::vector<Box> removed;
  bool empty() const { return added.empty() && removed.empty(); }
};

/// Compares by shape and position, independent of the order and numbers of the obstacles: O(n), and
/// O(m log m) in those between the first and the last difference.
WorldChange world_change(const World& before, const World& after);

}  // namespace swarm::planner
