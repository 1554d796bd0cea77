// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "robot_agent/methods/crops/fields/escape_walk.hpp"
#include "robot_agent/methods/crops/fields/give_way_field.hpp"
#include "robot_agent/methods/crops/fields/goal_field.hpp"
#include "robot_agent/methods/crops/fields/heading_field.hpp"
#include "robot_agent/methods/crops/fields/obstacle_field.hpp"
#include "robot_agent/methods/crops/fields/separation_field.hpp"
#include "robot_agent/methods/crops/fields/superposition.hpp"

namespace swarm::agent {
namespace {

Polygon box(double x0, double y0, double x1, double y1) {
  return Polygon::make({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}).value();
}

Neighbour at(Vec2 position, Vec2 velocity = Vec2::Zero()) {
  return {.robot = RobotId(1), .position_m = position, .velocity_mps = velocity, .radius_m = 0.2};
}

TEST(ObstacleField, GrowsWithTheInverseSquareOfTheGap) {
  const World world = World::make({{0, 0}, {20, 20}}, {box(10, 0, 12, 20)}).value();
  const ObstacleFieldOptions o{.radius_m = 0.2, .reach_m = 1.0, .gain_m = 0.065};

  const Vec2 field = obstacle_field({9.5, 10}, world, o);

  EXPECT_NEAR(field.x(), -0.5 * 0.065 / (0.3 * 0.3), 1e-9);  // (x − c) β/gap²
  EXPECT_NEAR(field.y(), 0.0, 1e-12);
  EXPECT_EQ(obstacle_field({8.7, 10}, world, o), Vec2::Zero());  // beyond Δ_obst
}

TEST(ObstacleField, IsFiniteAtContact) {
  const World world = World::make({{0, 0}, {20, 20}}, {box(10, 0, 12, 20)}).value();
  const ObstacleFieldOptions o;

  EXPECT_NEAR(obstacle_field({9.8, 10}, world, o).x(),
              -o.radius_m * o.gain_m / (o.gap_min_m * o.gap_min_m), 1e-9);
}

TEST(ObstacleField, CountsTheNearestPartOfEachObstacle) {
  // An L is cut into convex parts: it counts once. Its mirror image on the other side cancels it.
  const auto letter_l = Polygon::make({{5, 5}, {15, 5}, {15, 6}, {6, 6}, {6, 15}, {5, 15}}).value();
  const World one = World::make({{0, 0}, {20, 20}}, {letter_l}).value();
  const World two = World::make({{0, 0}, {20, 20}}, {box(0, 0, 20, 9), box(0, 11, 20, 20)}).value();
  ASSERT_GT(one.convex_obstacles().size(), 1U);

  EXPECT_NEAR(obstacle_field({6.5, 10}, one, {}).x(), 0.5 * 0.065 / 0.09, 1e-9);
  EXPECT_NEAR(obstacle_field({10, 10}, two, {}).norm(), 0.0, 1e-12);
}

TEST(SeparationField, IsTheSigmoidOfThePaper) {
  const SeparationFieldOptions o{.reach_m = 2.4, .steepness_per_m = 2.0, .gain_per_m = 3.0};
  const std::vector<Neighbour> neighbours{at({1, 0}), at({0, 3})};  // the second is too far

  const Vec2 field = separation_field({0, 0}, neighbours, o);

  EXPECT_NEAR(field.x(), -3.0 / (1.0 + std::exp(2.0)), 1e-12);
  EXPECT_EQ(field.y(), 0.0);
}

TEST(GiveWayField, YieldsToThoseNearerToTheGoalOnly) {
  const GiveWayFieldOptions o{.radius_m = 0.2, .gap_m = 0.4, .strength = 4.0};
  const std::vector<Neighbour> ahead{at({0.6, 0})};
  const std::vector<Neighbour> behind{at({-0.6, 0})};
  const std::vector<Neighbour> far_ahead{at({0.81, 0})};

  EXPECT_NEAR(give_way_field({0, 0}, {10, 0}, ahead, o).x(), -4.0 * (1.0 - 0.2 / 0.4), 1e-9);
  EXPECT_EQ(give_way_field({0, 0}, {10, 0}, behind, o), Vec2::Zero());
  EXPECT_EQ(give_way_field({0, 0}, {10, 0}, far_ahead, o), Vec2::Zero());
}

TEST(GiveWayField, LetsOneOfEachTwoGoFirst) {
  const std::vector<Neighbour> a{at({0, 0.3})};
  const std::vector<Neighbour> b{at({0.01, -0.3})};

  const bool a_yields = give_way_field({0.01, -0.3}, {5, 0}, a, {}) != Vec2::Zero();
  const bool b_yields = give_way_field({0, 0.3}, {5, 0}, b, {}) != Vec2::Zero();

  EXPECT_NE(a_yields, b_yields);
}

TEST(GoalField, IsOneFarFromTheGoalAndWeakerNearIt) {
  const GoalFieldOptions o;

  EXPECT_NEAR(goal_field({0, 0}, {0, 30}, o).y(), 1.0, 1e-9);
  EXPECT_NEAR(goal_field({0, 0}, {0.05, 0}, o).x(),
              0.75 + 0.25 / (1.0 + 50.0 * std::exp(-14.0 * 0.05)), 1e-12);
  EXPECT_EQ(goal_field({1, 1}, {1, 1}, o), Vec2::Zero());
}

TEST(HeadingField, FollowsThoseThatMoveAtTheRightDistance) {
  const HeadingFieldOptions o{.mean_m = 1.2, .sigma_m = 0.5, .moving_mps = 0.3, .strength = 0.6};
  const std::vector<Neighbour> neighbours{at({1.2, 0}, {0, 1.4}),       // at μ
                                          at({-1.7, 0}, {1.4, 0}),      // one σ off
                                          at({0, 1.2}, {-0.29, 0.0})};  // stuck: does not count
  const double weight = std::exp(-0.5);

  const Vec2 field = heading_field({0, 0}, neighbours, o);

  EXPECT_NEAR(field.y(), 0.6 / (1.0 + weight), 1e-12);
  EXPECT_NEAR(field.x(), 0.6 * weight / (1.0 + weight), 1e-12);
  EXPECT_EQ(heading_field({50, 0}, neighbours, o), Vec2::Zero());  // no neighbour near
}

TEST(Superposition, GivesTheStrongestTheMostInfluence) {
  const std::array<Vec2, 3> fields{Vec2(2, 0), Vec2(0, 1), Vec2(0, 0)};

  const Vec2 sum = superposition(fields);

  EXPECT_NEAR(sum.x(), 4.0 / 3.0, 1e-12);
  EXPECT_NEAR(sum.y(), 1.0 / 3.0, 1e-12);
  EXPECT_EQ(superposition(std::span(fields).last(1)), Vec2::Zero());
}

TEST(EscapeWalk, BeginsWhenTheRobotHasHardlyMovedForTheWholeWindow) {
  EscapeWalk sut({.window = 20, .moved_min_m = 0.3, .step = 5, .strength = 1.0});
  Rng rng(1);

  for (int tick = 0; tick < 20; ++tick) EXPECT_EQ(sut.update({0, 0}, rng), Vec2::Zero());
  const Vec2 first = sut.update({0, 0}, rng);

  EXPECT_TRUE(sut.is_stuck());
  EXPECT_NEAR(first.norm(), 1.0, 1e-12);
  EXPECT_EQ(sut.escapes(), 1U);
  for (int tick = 1; tick < 5; ++tick) EXPECT_EQ(sut.update({0, 0}, rng), first);
  EXPECT_NEAR(sut.update({0, 0}, rng).norm(), 2.0, 1e-12);  // the next step of the same walk
  EXPECT_EQ(sut.escapes(), 1U);
  for (int tick = 1; tick < 50; ++tick) sut.update({0, 0}, rng);
  EXPECT_NEAR(sut.update({0, 0}, rng).norm(), 4.0, 1e-12);
}

TEST(EscapeWalk, EndsWithItsStepOnceTheRobotMoves) {
  EscapeWalk sut({.window = 10, .moved_min_m = 0.3, .step = 5, .strength = 1.0});
  Rng rng(1);
  for (int tick = 0; tick <= 10; ++tick) sut.update({0, 0}, rng);

  Vec2 position(0, 0);
  for (int tick = 0; tick < 5; ++tick) sut.update(position += Vec2(0.15, 0), rng);

  EXPECT_FALSE(sut.is_stuck());
  EXPECT_EQ(sut.update(position, rng), Vec2::Zero());
}

TEST(EscapeWalk, DoesNotDisturbARobotThatMoves) {
  EscapeWalk sut({.window = 20, .moved_min_m = 0.3, .step = 5, .strength = 1.0});
  Rng rng(1);

  for (int tick = 0; tick < 200; ++tick) {
    EXPECT_EQ(sut.update({0.05 * tick, 0}, rng), Vec2::Zero());
  }
}

}  // namespace
}  // namespace swarm::agent
