// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "swarmflow/core/result.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm {

/// Share u of a robot in a stratified draw: the middle (i + ½)/n of its own stratum [i/n, (i+1)/n),
/// so that over all robots every cumulated weight is met within one robot. Neighbouring ids fall
/// into the same component. The same for every caller that knows (robot, robots); no communication.
/// \pre robot < robots; asserted
double stratified_share(std::uint32_t robot, std::uint32_t robots);

/// Positions of the simulated robots at the start [m]. Robot i belongs to the start component that
/// its stratified share falls into; its position is a sample of that Gaussian inside the 99 %
/// ellipse, safety.obstacle_margin_m away from the bounds and robots.placement_gap_m away from
/// obstacles and earlier robots. A function of (mission, seed).
/// Fails when a component is too dense to place its robots.
Result<std::vector<Vec2>> place_robots(const Mission& mission, std::uint64_t seed);

}  // namespace swarm
