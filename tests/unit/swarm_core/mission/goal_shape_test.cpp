// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission_file/goal_shape.hpp"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "swarmflow/mission/mission_file.hpp"

namespace swarm {
namespace {

const std::filesystem::path kFolder =
    std::filesystem::path(SWARM_SOURCE_DIR) / "tests/unit/swarm_core/mission";

Result<Mission> with_goal(const std::string& goal) {
  return parse_mission(
      "version: 1\n"
      "world: {bounds_m: [-10, -10, 110, 110]}\n"
      "start: [{mean_m: [3, 5], covariance_m2: [[1, 0], [0, 1]], weight: 1}]\n"
      "goal: " +
          goal,
      "shape", kFolder);
}

TEST(GoalShape, PolygonOfOneComponentHasItsMoments) {
  const auto mission =
      with_goal("{polygon_m: [[20, 30], [26, 30], [26, 42], [20, 42]], components: 1}");

  ASSERT_TRUE(mission.has_value()) << mission.error().message;
  ASSERT_EQ(mission->goal.components().size(), 1U);
  const Gaussian& g = mission->goal.components()[0].gaussian;
  EXPECT_LT((g.mean_m() - Vec2(23, 36)).norm(), 1e-9);
  EXPECT_LT((g.covariance_m2() - Mat2(Vec2(36.0 / 12, 144.0 / 12).asDiagonal())).norm(), 1e-9);
}

TEST(GoalShape, BitmapLiesWhereItsFramePutsIt) {
  const auto mission = with_goal(
      "{bitmap: {file: pictures/bars.pbm, origin_m: [50, 20], pixel_m: 5}, components: 2}");

  ASSERT_TRUE(mission.has_value()) << mission.error().message;
  const auto& components = mission->goal.components();
  ASSERT_EQ(components.size(), 2U);
  const auto& upper = components[components[0].weight > 0.5 ? 0 : 1];
  const auto& lower = components[components[0].weight > 0.5 ? 1 : 0];
  // Eight pixels of 5 m in the top row of four, four in the left half of the lowest one. The bars
  // are six of their standard deviations apart; what the one takes of the other is below 1e-3.
  EXPECT_NEAR(upper.weight, 2.0 / 3.0, 1e-3);
  EXPECT_LT((upper.gaussian.mean_m() - Vec2(70, 37.5)).norm(), 0.1);
  EXPECT_LT((lower.gaussian.mean_m() - Vec2(60, 22.5)).norm(), 0.1);
  EXPECT_NEAR(upper.gaussian.covariance_m2()(0, 0), 40.0 * 40.0 / 12, 1.0);
  EXPECT_NEAR(upper.gaussian.covariance_m2()(1, 1), 25.0 / 12, 0.1);
}

TEST(GoalShape, ChoosesComponentsAndKeepsTheSmallestSigma) {
  const std::string polygon =
      "{polygon_m: [[20, 30], [80, 30], [80, 32], [22, 32], [22, 90], "
      "[20, 90]], ";
  const auto chosen = with_goal(polygon + "components_max: 5, sigma_min_m: 0.7}");
  const auto asked = with_goal(polygon + "components: 9, sigma_min_m: 0.7}");

  ASSERT_TRUE(chosen.has_value() && asked.has_value());
  EXPECT_GT(chosen->goal.components().size(), 1U);
  EXPECT_LE(chosen->goal.components().size(), 5U);
  EXPECT_EQ(asked->goal.components().size(), 9U);
  for (const auto& [weight, gaussian] : asked->goal.components()) {
    EXPECT_GE(gaussian.min_sigma_m(), 0.7 - 1e-9);
  }
}

TEST(GoalShape, BecomesAnOrdinaryMixtureOfTheResolvedMission) {
  const auto mission =
      with_goal("{bitmap: {file: pictures/bars.pbm, origin_m: [50, 20], pixel_m: 5}}");
  ASSERT_TRUE(mission.has_value()) << mission.error().message;

  const auto again = parse_mission(to_yaml(*mission), "resolved");

  ASSERT_TRUE(again.has_value()) << again.error().message;
  ASSERT_EQ(again->goal.components().size(), mission->goal.components().size());
  for (std::size_t i = 0; i < again->goal.components().size(); ++i) {
    EXPECT_EQ(again->goal.components()[i].gaussian.mean_m(),
              mission->goal.components()[i].gaussian.mean_m());
    EXPECT_EQ(again->goal.components()[i].gaussian.covariance_m2(),
              mission->goal.components()[i].gaussian.covariance_m2());
  }
}

TEST(GoalShape, DrawingSurvivesInTheResolvedMission) {
  for (const char* goal :
       {"{bitmap: {file: pictures/bars.pbm, origin_m: [50, 20], pixel_m: 5.1}, components: 2}",
        "{polygon_m: [[20, 30], [80, 30.3], [50, 90], [50, 40]], components: 2}"}) {
    const auto mission = with_goal(goal);
    ASSERT_TRUE(mission.has_value()) << mission.error().message;
    ASSERT_NE(mission->goal_shape, nullptr);

    const auto again = parse_mission(to_yaml(*mission), "resolved");

    ASSERT_TRUE(again.has_value()) << again.error().message;
    ASSERT_NE(again->goal_shape, nullptr);
    EXPECT_EQ(again->goal_shape->polygons(), mission->goal_shape->polygons());
    ASSERT_EQ(again->goal_shape->boxes_m().size(), mission->goal_shape->boxes_m().size());
    for (std::size_t i = 0; i < again->goal_shape->boxes_m().size(); ++i) {
      EXPECT_EQ(again->goal_shape->boxes_m()[i].min_m, mission->goal_shape->boxes_m()[i].min_m);
      EXPECT_EQ(again->goal_shape->boxes_m()[i].max_m, mission->goal_shape->boxes_m()[i].max_m);
    }
    EXPECT_EQ(to_yaml(*again), to_yaml(*mission));
  }
}

TEST(GoalShape, MayBeAStart) {
  const auto mission = parse_mission(
      "version: 1\n"
      "world: {bounds_m: [0, 0, 50, 50]}\n"
      "start: {polygon_m: [[4, 4], [10, 4], [10, 16], [4, 16]], components: 1}\n"
      "goal: [{mean_m: [40, 40], covariance_m2: [[1, 0], [0, 1]], weight: 1}]\n",
      "shape");

  ASSERT_TRUE(mission.has_value()) << mission.error().message;
  ASSERT_EQ(mission->start.components().size(), 1U);
  EXPECT_LT((mission->start.components()[0].gaussian.mean_m() - Vec2(7, 10)).norm(), 1e-9);
}

TEST(GoalShape, IsTheSameEveryTime) {
  const std::string goal = "{polygon_m: [[20, 30], [80, 30], [50, 90]], components: 12}";

  const auto first = with_goal(goal);
  const auto second = with_goal(goal);

  ASSERT_TRUE(first.has_value() && second.has_value());
  EXPECT_EQ(to_yaml(*first), to_yaml(*second));
}

}  // namespace
}  // namespace swarm
