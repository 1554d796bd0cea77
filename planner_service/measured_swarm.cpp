// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/planning/measured_swarm.hpp"

#include <utility>

#include "swarm_core/base/assert.hpp"

namespace swarm::planner {

// Each group weighs as much as its share of the robots that reported.
Mixture mixture_of(std::span<const RobotGroup> groups) {
  std::size_t robots = 0;
  for (const RobotGroup& group : groups) robots += group.members.size();
  std::vector<WeightedGaussian> components;
  for (const RobotGroup& group : groups) {
    components.push_back(
        {static_cast<double>(group.members.size()) / static_cast<double>(robots), group.gaussian});
  }
  Result<Mixture> mixture = Mixture::make(std::move(components));
  SWARM_ASSERT(mixture.has_value());
  return *std::move(mixture);
}

}  // namespace swarm::planner
