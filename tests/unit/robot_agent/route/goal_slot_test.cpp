// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/route/goal_slot.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;

const Gaussian kGoal = Gaussian::from_parameters({10, 10}, 1.0, 1.0, 0.0);  // to 3.03 m
const World kOpen = World::make({{0, 0}, {20, 20}}, {}).value();

SteadyTime at(int ms) { return SteadyTime(milliseconds(ms)); }

Vec2 keep(GoalSlot& place, const Vec2& position_m, const std::vector<Vec2>& others_m) {
  std::vector<Neighbour> neighbours;
  for (const Vec2& other : others_m) {
    neighbours.push_back({.robot = RobotId(1), .position_m = other, .radius_m = 0.2});
  }
  return place.keep({.now = at(0),
                     .position_m = position_m,
                     .neighbours = neighbours,
                     .world = kOpen,
                     .close = neighbours});
}

TEST(GoalSlot, IsReachedInTheGoalNearTheOwnSlot) {
  GoalSlot sut(kGoal, {11, 10}, {});

  EXPECT_FALSE(sut.has_arrived(at(0), {7.5, 10}));  // inside, but far from the slot
  EXPECT_TRUE(sut.has_arrived(at(100), {10.5, 10}));
  EXPECT_FALSE(sut.has_arrived(at(200), {13.1, 10}));  // pushed out
  EXPECT_EQ(sut.aim_m(), Vec2(11, 10));
}

TEST(GoalSlot, IsWhereTheRobotIsWhenItsPathIsBlocked) {
  GoalSlot sut(kGoal, {12, 10}, {});

  int ms = 0;
  for (; ms < 1900; ms += 100) ASSERT_FALSE(sut.has_arrived(at(ms), {8, 10}));
  for (; ms < 2300; ms += 100) sut.has_arrived(at(ms), {8, 10});

  EXPECT_TRUE(sut.has_arrived(at(ms), {8, 10}));
  EXPECT_EQ(sut.aim_m(), Vec2(8, 10));
}

TEST(GoalSlot, DoesNotCountTheTimeTheRobotIsHeld) {
  GoalSlot sut(kGoal, {12, 10}, {});

  for (int ms = 0; ms < 10'000; ms += 100) {
    EXPECT_FALSE(sut.has_arrived(at(ms), {8, 10}));
    sut.wait(at(ms));
  }
}

TEST(GoalSlot, LeadsToTheMiddleWhenThePathIsBlockedOutside) {
  GoalSlot sut(kGoal, {12, 10}, {});

  for (int ms = 0; ms < 2300; ms += 100) EXPECT_FALSE(sut.has_arrived(at(ms), {6, 10}));

  EXPECT_EQ(sut.aim_m(), Vec2(10, 10));
}

TEST(GoalSlot, IsKeptWhileThereIsRoom) {
  GoalSlot sut(kGoal, {11, 10}, {});

  EXPECT_EQ(keep(sut, {11, 10.05}, {{11, 11}}), Vec2::Zero());
  const Vec2 back = keep(sut, {11, 10.6}, {});
  EXPECT_EQ(back.x(), 0.0);
  EXPECT_LT(back.y(), -0.2);
}

TEST(GoalSlot, PassesPressureFromOutsideOn) {
  GoalSlot sut(kGoal, {12, 10}, {});

  // Between a robot still outside (13.05, 0.7 m away) and one farther in: inwards.
  const Vec2 desired_velocity = keep(sut, {12.35, 10}, {{13.05, 10}, {11.65, 10}});

  EXPECT_LT(desired_velocity.x(), -0.2);
  EXPECT_EQ(sut.aim_m(), Vec2(12.35, 10));  // it does not come back
}

TEST(GoalSlot, DoesNotLeaveTheGoalToMakeRoom) {
  GoalSlot sut(kGoal, {12.9, 10}, {});

  const Vec2 desired_velocity = keep(sut, {12.95, 10}, {{12.35, 10.2}});

  EXPECT_LE(desired_velocity.x(), 1e-12);
  EXPECT_LT(desired_velocity.y(), 0.0);  // along the rim
}

TEST(GoalSlot, ComesBackFromBeyondTheRim) {
  GoalSlot sut(kGoal, {12.9, 10}, {});

  EXPECT_EQ(keep(sut, {12.85, 10}, {}), Vec2::Zero());
  EXPECT_LT(keep(sut, {12.95, 10}, {}).x(), -0.05);
  EXPECT_LT(keep(sut, {13.02, 10}, {}).x(), keep(sut, {12.95, 10}, {}).x());
}

}  // namespace
}  // namespace swarm::agent
