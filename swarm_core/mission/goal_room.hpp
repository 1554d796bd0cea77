// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "swarmflow/core/mixture.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm {

/// Largest number of points with distances of at least d in the 99 % ellipse of a Gaussian:
///
///   n ≤ 2/√3 · A/d² + P/(2d) + 1                                              [Oler 1961]
///
/// with its area A and an upper bound of its perimeter P. The bound holds for every convex set, so
/// no placement of robots of diameter d is better.
std::uint32_t most_in_goal(const Gaussian& goal, double distance_m);

/// Robots by which a goal component may be off its share at the end of a mission: robots choose
/// goals by their share of the mixture, which rounds. Two robots, or 2 % of a large swarm.
double goal_tolerance(std::uint32_t robots);

/// Why a mission's robots cannot all be in its last goal, that of the script if it sets one;
/// nothing if they may fit. Robots of different size count as the smallest ones, so that no mission
/// is refused that can succeed. A goal that is drawn is filled by another rule.
std::optional<std::string> lack_of_goal_room(const Mission& mission);

/// A goal and how messages name it.
struct NamedGoal {
  const Mixture* mixture = nullptr;  ///< not null
  std::string path;                  ///< such as "script[2].goal"
};

/// The same of another goal, for all robots but those that are `lost`.
std::optional<std::string> lack_of_goal_room(const Mission& mission, const NamedGoal& goal,
                                             std::uint32_t lost = 0);

/// Why an obstacle that a user adds would have no effect: it lies outside of the bounds, where no
/// robot drives. Most likely its coordinates are those of another map.
std::optional<std::string> lack_of_place(const Obstacle& obstacle, const Box& bounds_m);

}  // namespace swarm
