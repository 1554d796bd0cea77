// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/planning/measured_swarm.hpp"
#include "tests/unit/planner_service/planners.hpp"
#include "tests/unit/planner_service/standin_scene.hpp"

namespace swarm::test {

/// Robots spread along a plan of the stand-in scene that is half done, as far from obstacles as
/// robots are.
inline std::vector<planner::ReportedRobot> robots_in_flight(std::uint32_t count) {
  const StandinScene scene = standin_scene();
  Rng rng(1);
  const auto planned = plan_once({scene.world, scene.start, scene.goal}, {}, rng);
  EXPECT_TRUE(planned.has_value());
  std::vector<planner::ReportedRobot> robots;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double at = uniform(rng, 0.1, 0.8);
    const Mixture mixture = planned->plan.mixture_at(at * planned->plan.duration());
    for (;;) {
      const Gaussian& g = mixture.components()[mixture.component_at((i + 0.5) / count)].gaussian;
      const double u = standard_normal(rng);
      const Vec2 p = g.mean_m() + cholesky_lower(g.covariance_m2()) * Vec2(u, standard_normal(rng));
      if (!scene.world.is_clear(p, 0.25)) continue;
      robots.push_back({RobotId(i), p, false});
      break;
    }
  }
  return robots;
}

}  // namespace swarm::test
