// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/late_robots.hpp"

#include <chrono>

#include <gtest/gtest.h>

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;

SteadyTime at(int ms) { return SteadyTime(std::chrono::hours(1) + milliseconds(ms)); }

TEST(LateRobots, AreThoseWhoseNextStatusIsLate) {
  LateRobots sut(3, 2.0);  // two statuses a second
  sut.on_status(RobotId(1), {4.0, 2.0}, at(-30), at(0));

  EXPECT_TRUE(sut.at(at(625)).empty());
  ASSERT_EQ(sut.at(at(626)).size(), 1U);
  EXPECT_EQ(sut.at(at(626))[0],
            (link::LateRobot{.robot = 1, .age_ms = 656, .x_m = 4.0, .y_m = 2.0}));

  sut.on_status(RobotId(1), {5.0, 2.0}, at(670), at(700));
  EXPECT_TRUE(sut.at(at(800)).empty());
}

TEST(LateRobots, AreNotThoseWithoutAnyStatus) {
  LateRobots sut(3, 1.0);
  EXPECT_TRUE(sut.at(at(100'000)).empty());
}

// By then the scene has had its body for three seconds.
TEST(LateRobots, AreLateUntilTheirBodiesAreObstacles) {
  LateRobots sut(3, 1.0);
  sut.on_status(RobotId(1), {4.0, 2.0}, at(0), at(0));
  EXPECT_EQ(sut.at(at(6000)).size(), 1U);
  EXPECT_TRUE(sut.at(at(6001)).empty());
}

TEST(LateRobots, AreInTheOrderOfTheirSilence) {
  LateRobots sut(3, 1.0);
  sut.on_status(RobotId(0), {0.0, 0.0}, at(0), at(0));
  sut.on_status(RobotId(1), {0.0, 0.0}, at(700), at(700));
  sut.on_status(RobotId(2), {0.0, 0.0}, at(300), at(300));
  const auto late = sut.at(at(2500));
  ASSERT_EQ(late.size(), 3U);
  EXPECT_EQ(late[0].robot, 1U) << "the newest first: the others are obstacles sooner";
  EXPECT_EQ(late[1].robot, 2U);
  EXPECT_EQ(late[2].robot, 0U);
}

}  // namespace
}  // namespace swarm::launcher
