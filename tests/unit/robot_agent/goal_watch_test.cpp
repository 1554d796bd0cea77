// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/goal_watch.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::agent {
namespace {

SteadyTime at_s(double s) { return SteadyTime(from_seconds(1000.0 + s)); }

// σ = 2 m: the 99 % ellipse is a circle of radius 6.07 m.
Gaussian goal() { return Gaussian::from_parameters({10, 0}, 2.0, 2.0, 0.0); }

TEST(GoalWatch, HasArrivedInsideTheGoalNearTheEndPoint) {
  struct Case {
    Vec2 end_m, position_m;
    bool arrived;
  };
  const Case cases[] = {{{10, 0}, {10.99, 0}, true}, {{10, 0}, {11.01, 0}, false},
                        {{15, 0}, {15.5, 0}, true},  {{16, 0}, {16.05, 0}, true},
                        {{16, 0}, {16.1, 0}, false},  // near its end point, outside of the goal
                        {{20, 0}, {20, 0}, false}};
  for (const auto& [end_m, position_m, arrived] : cases) {
    GoalWatch sut(goal(), end_m);
    EXPECT_EQ(sut.has_arrived(at_s(0), position_m), arrived) << position_m.transpose();
  }
}

TEST(GoalWatch, AcceptsADensePlaceAfterThreeSecondsWithoutProgress) {
  GoalWatch sut(goal(), {10, 0});

  EXPECT_FALSE(sut.has_arrived(at_s(0.0), {13.9, 0}));
  EXPECT_FALSE(sut.has_arrived(at_s(3.0), {13.85, 0}));  // 5 cm is no progress
  EXPECT_TRUE(sut.has_arrived(at_s(3.1), {13.85, 0}));
}

TEST(GoalWatch, CountsTheTimeFromTheLastProgress) {
  GoalWatch sut(goal(), {10, 0});

  EXPECT_FALSE(sut.has_arrived(at_s(0.0), {13.9, 0}));
  EXPECT_FALSE(sut.has_arrived(at_s(2.9), {13.7, 0}));
  // Pushed away and back is no progress.
  EXPECT_FALSE(sut.has_arrived(at_s(3.5), {15.0, 0}));
  EXPECT_FALSE(sut.has_arrived(at_s(5.8), {13.65, 0}));
  EXPECT_TRUE(sut.has_arrived(at_s(6.0), {13.65, 0}));
}

TEST(GoalWatch, AcceptsAnyPlaceWellInsideAfterFifteenSecondsWithoutProgress) {
  GoalWatch sut(goal(), {10, 0});

  for (int s = 0; s <= 15; ++s) EXPECT_FALSE(sut.has_arrived(at_s(s), {14.01, 0})) << s;
  EXPECT_TRUE(sut.has_arrived(at_s(15.1), {14.01, 0}));
  EXPECT_TRUE(sut.has_arrived(at_s(16.0), {16.0, 0}));
}

TEST(GoalWatch, AcceptsNoPlaceAtTheRimWithoutProgress) {
  GoalWatch sut(goal(), {10, 0});

  for (int s = 0; s < 100; ++s) EXPECT_FALSE(sut.has_arrived(at_s(s), {15.1, 0})) << s;
}

// A new obstacle lies between the robot and its end point: it drives to and fro beside it.
TEST(GoalWatch, AcceptsARobotThatDrivesToAndFroInItsGoal) {
  GoalWatch sut(goal(), {6, 0});

  bool arrived = false;
  for (double s = 0.0; s < 20.0; s += 0.1) {
    arrived = sut.has_arrived(at_s(s), {11.0, 3.0 * std::sin(s)});
    if (s < 15.0) {
      EXPECT_FALSE(arrived) << s;
    }
  }
  EXPECT_TRUE(arrived);
}

TEST(GoalWatch, StaysArrivedInsideTheGoal) {
  GoalWatch sut(goal(), {10, 0});
  EXPECT_TRUE(sut.has_arrived(at_s(0.0), {10.5, 0}));

  EXPECT_TRUE(sut.has_arrived(at_s(0.1), {16.0, 0}));
  EXPECT_FALSE(sut.has_arrived(at_s(0.2), {16.1, 0}));
  // Having left the goal, it arrives near its end point again.
  EXPECT_FALSE(sut.has_arrived(at_s(0.3), {15.9, 0}));
  EXPECT_TRUE(sut.has_arrived(at_s(0.4), {10.9, 0}));
}

// Reference: the rule, evaluated over the whole history at every tick.
TEST(GoalWatch, FollowsItsRuleOnRandomPaths) {
  Rng rng(4);
  for (int round = 0; round < 100; ++round) {
    const Vec2 end_m(uniform(rng, 6, 14), uniform(rng, -3, 3));
    GoalWatch sut(goal(), end_m);
    Vec2 position_m(uniform(rng, 5, 18), uniform(rng, -5, 5));
    double best_m = 1e9;
    double best_at_s = 0.0;
    bool arrived = false;
    for (int tick = 0; tick < 300; ++tick) {
      const double now_s = 0.1 * tick;
      const double left_m = (end_m - position_m).norm();
      const bool inside = goal().contains_99(position_m);
      if (!arrived && left_m < best_m - 0.1) {
        best_m = left_m;
        best_at_s = now_s;
      }
      const double stalled_s = now_s - best_at_s - 1e-9;
      const bool dense = left_m < 4.0 && stalled_s > 3.0;
      const bool blocked = goal().mahalanobis_squared(position_m) < 6.44 && stalled_s > 15.0;
      arrived = inside && (arrived || left_m < 1.0 || dense || blocked);

      ASSERT_EQ(sut.has_arrived(at_s(now_s), position_m), arrived) << round << ' ' << tick;
      position_m += Vec2(uniform(rng, -0.2, 0.2), uniform(rng, -0.2, 0.2));
    }
  }
}

TEST(GoalWatch, IsForTheSameEndPointInTheSameGoal) {
  const GoalWatch sut(goal(), {9, 1});

  EXPECT_TRUE(sut.is_for(goal(), {9, 1}));
  EXPECT_TRUE(sut.is_for(goal(), {9 + 1e-7, 1}));
  EXPECT_FALSE(sut.is_for(goal(), {9.01, 1}));
  EXPECT_FALSE(sut.is_for(Gaussian::from_parameters({10.01, 0}, 2, 2, 0), {9, 1}));
}

}  // namespace
}  // namespace swarm::agent
