// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission/goal_room.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "swarmflow/mission/mission_file.hpp"

namespace swarm {
namespace {

Gaussian round_goal(double sigma_m) {
  return *Gaussian::make({10, 5}, Mat2::Identity() * sigma_m * sigma_m);
}

/// Points of a hexagonal lattice in the 99 % ellipse, with a point at its mean.
std::uint32_t lattice_points(const Gaussian& goal, double distance_m) {
  const double reach_m = 4.0 * goal.max_sigma_m();
  const int n = static_cast<int>(reach_m / distance_m) + 2;
  std::uint32_t count = 0;
  for (int row = -2 * n; row <= 2 * n; ++row) {
    for (int column = -2 * n; column <= 2 * n; ++column) {
      const Vec2 offset(distance_m * (column + 0.5 * row),
                        distance_m * 0.5 * std::numbers::sqrt3 * row);
      if (goal.contains_99(goal.mean_m() + offset)) ++count;
    }
  }
  return count;
}

std::string mission_text(std::uint32_t robots, double sigma_m, const std::string& script = "") {
  return "version: 1\nworld: {bounds_m: [0, 0, 40, 30]}\n"
         "robots: {count: " +
         std::to_string(robots) +
         ", radius_m: 0.2}\n"
         "start: [{mean_m: [8, 15], covariance_m2: [[9, 0], [0, 9]], weight: 1}]\n"
         "goal: [{mean_m: [32, 15], covariance_m2: [[" +
         std::to_string(sigma_m * sigma_m) + ", 0], [0, " + std::to_string(sigma_m * sigma_m) +
         "]], weight: 1}]\n" + script;
}

TEST(GoalRoom, IsNoLessThanADensePackingHas) {
  for (const double sigma_m : {0.05, 0.1, 0.2, 0.5, 1.0, 3.0}) {
    const Gaussian goal = round_goal(sigma_m);
    EXPECT_GE(most_in_goal(goal, 0.4), lattice_points(goal, 0.4)) << sigma_m;
  }
  const auto flat = *Gaussian::make({0, 0}, (Mat2() << 4.0, 0.0, 0.0, 0.0025).finished());
  EXPECT_GE(most_in_goal(flat, 0.4), lattice_points(flat, 0.4));
}

TEST(GoalRoom, IsLittleMoreThanADensePackingHasOfMany) {
  const Gaussian goal = round_goal(3.0);
  EXPECT_LT(most_in_goal(goal, 0.4), 1.05 * lattice_points(goal, 0.4));
}

TEST(GoalRoom, IsDemandedOfAMission) {
  EXPECT_TRUE(parse_mission(mission_text(12, 0.5), "m.yaml"));
  EXPECT_TRUE(parse_mission(mission_text(2, 0.1), "m.yaml"));
  const auto refused = parse_mission(mission_text(12, 0.1), "m.yaml");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("goal[0] has no room for 12 robots"), std::string::npos)
      << refused.error().message;
}

TEST(GoalRoom, IsDemandedOfTheLastGoalAlone) {
  const auto go_to = [](double variance) {
    return "script: [{at_s: 5, action: goto, goal: [{mean_m: [30, 8], covariance_m2: [[" +
           std::to_string(variance) + ", 0], [0, " + std::to_string(variance) +
           "]], weight: 1}]}]\n";
  };
  EXPECT_TRUE(parse_mission(mission_text(12, 0.1, go_to(1.0)), "m.yaml"));
  const auto refused = parse_mission(mission_text(12, 1.0, go_to(0.01)), "m.yaml");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("script[0].goal[0] has no room"), std::string::npos)
      << refused.error().message;
}

TEST(GoalRoom, CountsTheRobotsOfTheCommandLine) {
  EXPECT_TRUE(parse_mission(mission_text(12, 0.1), "m.yaml", {}, open_catalogue(), 3));
  EXPECT_FALSE(parse_mission(mission_text(3, 0.1), "m.yaml", {}, open_catalogue(), 12));
}

TEST(GoalRoom, IsThatOfTheRobotsThatAreLeft) {
  const auto mission = parse_mission(mission_text(12, 0.5), "m.yaml");
  ASSERT_TRUE(mission);
  const Mixture tiny = *Mixture::make({{1.0, round_goal(0.01)}});
  EXPECT_TRUE(lack_of_goal_room(*mission, {&tiny, "goal"}));
  EXPECT_FALSE(lack_of_goal_room(*mission, {&tiny, "goal"}, 11)) << "one robot fits";
}

TEST(Place, HaveObstaclesThatTouchTheBounds) {
  const Box bounds_m{{0, 0}, {40, 30}};
  const auto polygon = [](double x_m) {
    return Obstacle(*Polygon::make({{x_m, 5}, {x_m + 2, 5}, {x_m + 1, 8}}));
  };
  EXPECT_FALSE(lack_of_place(polygon(10), bounds_m));
  EXPECT_FALSE(lack_of_place(polygon(-1), bounds_m)) << "a part is inside";
  EXPECT_TRUE(lack_of_place(polygon(-3), bounds_m));
  EXPECT_TRUE(lack_of_place(Circle{.center_m = {50, 5}, .radius_m = 9}, bounds_m));
  EXPECT_FALSE(lack_of_place(Circle{.center_m = {50, 5}, .radius_m = 11}, bounds_m));
}

}  // namespace
}  // namespace swarm
