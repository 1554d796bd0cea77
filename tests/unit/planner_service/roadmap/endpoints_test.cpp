// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/endpoints.hpp"

#include <gtest/gtest.h>

#include "tests/unit/planner_service/standin_scene.hpp"

namespace swarm::planner {
namespace {

bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Endpoints, HaveNothingToReportWhenTheLimitHolds) {
  const auto scene = test::standin_scene();

  EXPECT_EQ(describe_violations(scene.start, "start", scene.world, {}), "");
  EXPECT_EQ(describe_violations(scene.goal, "goal", scene.world, {}), "");
}

TEST(Endpoints, NameComponentObstacleAndRemedy) {
  const auto scene = test::standin_scene();
  const RiskLimit strict{.alpha = 0.01, .delta_m = -0.2};

  const std::string text = describe_violations(scene.start, "start", scene.world, strict);

  // 25 m from a wall with k(0.01) = 2.6652: CVaR = −25 + 26.652 = 1.652; room for σ = 24.8
  // / 2.6652.
  EXPECT_TRUE(mentions(text, "start component 0 at (25.0, 20.0) m is too near obstacle 2")) << text;
  EXPECT_TRUE(mentions(text, "CVaR 1.652 m > delta -0.200 m at alpha 0.01")) << text;
  EXPECT_TRUE(mentions(text, "from 10.00 m to 9.31 m")) << text;
  EXPECT_TRUE(mentions(text, "planner.risk_alpha")) << text;
  EXPECT_TRUE(mentions(text, "start component 3")) << text;
}

TEST(Endpoints, NameTheObstacleOfTheMissionNotItsConvexPart) {
  const auto l_shape =
      Polygon::make({{0, 0}, {30, 0}, {30, 10}, {10, 10}, {10, 30}, {0, 30}}).value();
  const World world =
      World::make({{-50, -50}, {50, 50}}, {Circle{{-40, -40}, 1.0}, l_shape}).value();
  const Mixture inside =
      Mixture::make({{1.0, Gaussian::from_parameters({5, 25}, 1, 1, 0)}}).value();

  const std::string text = describe_violations(inside, "goal", world, {});

  EXPECT_TRUE(mentions(text, "goal component 0")) << text;
  EXPECT_TRUE(mentions(text, "obstacle 1:")) << text;
  EXPECT_TRUE(mentions(text, "move it away")) << text;
}

}  // namespace
}  // namespace swarm::planner
