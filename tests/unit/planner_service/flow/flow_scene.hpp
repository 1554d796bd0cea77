// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "planner_service/roadmap/connect.hpp"
#include "planner_service/roadmap/edge_check.hpp"
#include "swarmflow/core/random.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::test {

/// An open field with two wide start components on the left, two goal components on the right and
/// `samples` narrow nodes between them that carry little.
struct FlowScene {
  World world;
  RiskLimit risk;
  std::vector<double> supplies{0.4, 0.6};
  std::vector<double> demands{0.7, 0.3};
  planner::Roadmap roadmap;
};

inline FlowScene flow_scene(std::uint64_t seed, std::size_t samples, double radius_m = 16.0,
                            double sigma_max_m = 3.0) {
  FlowScene scene{.world = World::make({{0, 0}, {60, 30}}, {}).value(), .risk = {}, .roadmap = {}};
  const auto wide = [](double x, double y) {
    return Gaussian::from_parameters({x, y}, 4.0, 4.0, 0.0);
  };
  std::vector<Gaussian> nodes{wide(5, 8), wide(5, 22), wide(55, 8), wide(55, 22)};
  Rng rng(seed);
  for (std::size_t i = 0; i < samples; ++i) {
    const double x = uniform(rng, 12.0, 48.0);
    const double y = uniform(rng, 3.0, 27.0);
    const double sigma1_m = uniform(rng, 0.5, sigma_max_m);
    nodes.push_back(
        Gaussian::from_parameters({x, y}, sigma1_m, uniform(rng, 0.5, sigma_max_m), 0.3));
  }
  planner::EdgeChecker checker(scene.world, scene.risk);
  scene.roadmap = planner::connect(std::move(nodes), radius_m, checker, 4);
  return scene;
}

}  // namespace swarm::test
