// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::test {

/// Shortest path from start to goal means on the stand-in scene, obstacles grown by 0.2 m, means
/// assigned as the transport problem does [m].
inline constexpr double kStandinMeanBound_m = 182.4;

/// SwarmPRM's scene: its start and goal mixtures [SwarmPRM, sec. V]; the obstacles stand in,
/// because the paper does not print their coordinates.
struct StandinScene {
  World world;
  Mixture start;
  Mixture goal;
};

inline StandinScene standin_scene() {
  const auto polygon = [](std::vector<Vec2> vertices) {
    return Polygon::make(std::move(vertices)).value();
  };
  const auto component = [](double weight, double x, double y) {
    return WeightedGaussian{weight, Gaussian::from_parameters({x, y}, 10.0, 10.0, 0.0)};
  };
  return {
      World::make({{0, 0}, {200, 160}}, {polygon({{50, 160}, {50, 80}, {70, 80}, {70, 160}}),
                                         polygon({{70, 160}, {70, 120}, {150, 120}, {150, 160}}),
                                         polygon({{50, 40}, {50, 0}, {130, 0}, {130, 40}}),
                                         polygon({{130, 80}, {130, 0}, {150, 0}, {150, 80}}),
                                         polygon({{90, 100}, {90, 80}, {110, 80}, {115, 100}}),
                                         polygon({{90, 80}, {85, 60}, {110, 60}, {110, 80}})})
          .value(),
      Mixture::make({component(0.25, 25, 20), component(0.375, 25, 40), component(0.1875, 25, 120),
                     component(0.1875, 25, 140)})
          .value(),
      Mixture::make(
          {component(0.25, 175, 40), component(0.375, 175, 60), component(0.375, 175, 120)})
          .value()};
}

}  // namespace swarm::test
