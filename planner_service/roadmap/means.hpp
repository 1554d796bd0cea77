// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "swarmflow/core/random.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::planner {

/// Uniform point of the box.
Vec2 uniform_mean(const Box& bounds_m, Rng& rng);

/// Points of the Halton sequence with bases 2 and 3, shifted modulo 1 by a random vector: as evenly
/// spread for every seed, but not the same.
class HaltonMeans {
 public:
  HaltonMeans(const Box& bounds_m, Rng& rng);
  Vec2 next();

 private:
  Box bounds_m_;
  Vec2 shift_;
  std::uint32_t index_ = 0;
};

/// One try of the Gaussian sampler of Boor, Overmars and van der Stappen: a uniform point and a
/// normal one around it; if exactly one of them is free, that one is an answer, so answers gather
/// along obstacles. A point is free when it is farther than `clearance_m` from every obstacle.
std::optional<Vec2> near_obstacle_mean(const World& world, double spread_m, double clearance_m,
                                       Rng& rng);

}  // namespace swarm::planner
