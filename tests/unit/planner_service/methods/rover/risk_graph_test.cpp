// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/risk_graph.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "swarm_core/gmm/wasserstein.hpp"
#include "tests/unit/planner_service/methods/rover/rover_scene.hpp"

namespace swarm::planner {
namespace {

TEST(CollocationSet, IsThePapersOnItsArea) {
  const auto set = collocation_set({{0, 0}, {200, 160}}, {}).value();

  ASSERT_EQ(set.size(), 320U);
  EXPECT_TRUE(set.front().mean_m().isApprox(Vec2(5, 5)));
  EXPECT_TRUE(set.back().mean_m().isApprox(Vec2(195, 155)));
  EXPECT_TRUE(set[7].covariance_m2().isApprox(50.0 * Mat2::Identity()));
}

TEST(CollocationSet, RefusesGridsOfNothingAndOfTooMany) {
  EXPECT_FALSE(collocation_set({{0, 0}, {5, 5}}, {.spacing_m = 10.0}));
  EXPECT_FALSE(collocation_set({{0, 0}, {200, 160}}, {.spacing_m = 0.1}));
  EXPECT_FALSE(collocation_set({{0, 0}, {200, 160}}, {.spacing_m = -1.0}));
  EXPECT_FALSE(collocation_set({{0, 0}, {200, 160}}, {.sigma_m = std::nan("")}));
}

TEST(RiskGraph, ArcsStayWithinTheRadiusAndClearOfObstacles) {
  const Mission mission = test::rover_scene(2);
  const RiskGraph graph = RiskGraph::make(mission.world, mission.goal, {}).value();
  const double radius_m = graph.options().transport_radius_m;

  for (std::uint32_t v = 0; v < graph.vertices().size(); ++v) {
    const Gaussian& from = graph.vertices()[v];
    std::size_t expected = 1;  // to itself
    for (std::uint32_t w = 0; w < graph.vertices().size(); ++w) {
      if (w == v || wasserstein2(from, graph.vertices()[w]) > radius_m) continue;
      expected += mission.world.segment_is_free(from.mean_m(), graph.vertices()[w].mean_m(),
                                                graph.options().mean_clearance_m)
                      ? 1
                      : 0;
    }
    EXPECT_EQ(graph.arcs_of(v).size(), expected) << v;
  }
}

TEST(RiskGraph, CostsToTheGoalAreThoseOfBellmanAndFord) {
  const Mission mission = test::rover_scene(3);
  const RiskGraph graph = RiskGraph::make(mission.world, mission.goal, {}).value();
  for (std::size_t n = 0; n < graph.goals(); ++n) {
    std::vector<double> cost_m(graph.vertices().size(), std::numeric_limits<double>::infinity());
    cost_m[n] = 0.0;
    for (bool changed = true; changed;) {
      changed = false;
      for (std::uint32_t v = 0; v < cost_m.size(); ++v) {
        for (const RiskGraph::Arc& arc : graph.arcs_of(v)) {
          if (cost_m[arc.to] + arc.length_m >= cost_m[v] - 1e-12) continue;
          cost_m[v] = cost_m[arc.to] + arc.length_m;
          changed = true;
        }
      }
    }
    for (std::uint32_t v = 0; v < cost_m.size(); ++v) {
      if (std::isinf(cost_m[v])) {
        EXPECT_TRUE(std::isinf(graph.to_goal_m(v, n)));
      } else {
        EXPECT_NEAR(graph.to_goal_m(v, n), cost_m[v], 1e-9);
      }
    }
  }
}

TEST(RiskGraph, ForgetsSourcesWithoutATrace) {
  const Mission mission = test::rover_scene(1);
  RiskGraph graph = RiskGraph::make(mission.world, mission.goal, {}).value();
  const auto sizes = [&] {
    std::vector<std::size_t> all{graph.vertices().size(), graph.arcs().size()};
    for (std::size_t part = 0; part < 2; ++part) {
      for (std::size_t o = 0; o < mission.world.convex_obstacles().size(); ++o) {
        all.push_back(graph.near(part, o).size());
      }
    }
    return all;
  };
  const auto before = sizes();

  const auto source = graph.add_source(Gaussian::from_parameters({61, 66}, 6.0, 3.0, 0.2));

  ASSERT_TRUE(source.has_value());
  EXPECT_GT(graph.arcs_of(*source).size(), 3U);
  EXPECT_TRUE(std::isfinite(graph.to_goal_m(*source, 0)));
  EXPECT_NE(sizes(), before);
  graph.drop_sources();
  EXPECT_EQ(sizes(), before);
  EXPECT_FALSE(graph.add_source(Gaussian::from_parameters({50, 50}, 3.0, 3.0, 0.0)));
  EXPECT_EQ(sizes(), before);
}

TEST(RiskGraph, RefusesAGoalInAnObstacleAndBadOptions) {
  const Mission mission = test::rover_scene(1);
  const Mixture inside =
      Mixture::make({{1.0, Gaussian::from_parameters({100, 50}, 5.0, 5.0, 0.0)}}).value();

  EXPECT_EQ(RiskGraph::make(mission.world, inside, {}).error().code, ErrorCode::kInfeasible);
  EXPECT_EQ(RiskGraph::make(mission.world, mission.goal, {.transport_radius_m = 0.0}).error().code,
            ErrorCode::kBadInput);
  EXPECT_EQ(RiskGraph::make(mission.world, mission.goal, {.checks_between = 1000}).error().code,
            ErrorCode::kBadInput);
}

}  // namespace
}  // namespace swarm::planner
