// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/keeper/robot_watch.hpp"

#include <gtest/gtest.h>

namespace swarm::planner {
namespace {

using std::chrono::seconds;

SteadyTime at(int s) { return SteadyTime(seconds(1000 + s)); }

TEST(RobotWatch, ForgetsRobotsWithoutUpdates) {
  RobotWatch watch(2, seconds(5));
  watch.receive({RobotId(0), {1, 1}, false}, true, at(0));
  watch.receive({RobotId(1), {2, 2}, false}, true, at(4));

  EXPECT_TRUE(watch.received_all(at(5)));
  EXPECT_FALSE(watch.received_all(at(6)));
  ASSERT_EQ(watch.fresh(at(6)).size(), 1U);
  EXPECT_EQ(watch.fresh(at(6))[0].robot, RobotId(1));
}

TEST(RobotWatch, DistinguishesStuckFromRestingAndSlowRobots) {
  RobotWatch watch(3, seconds(5));
  for (int s = 0; s <= 10; ++s) {
    watch.receive({RobotId(0), {1.0 + 0.01 * s, 1}, false}, true, at(s));  // under way but blocked
    watch.receive({RobotId(1), {2, 2}, true}, false, at(s));               // arrived
    watch.receive({RobotId(2), {3.0 + 0.1 * s, 3}, false}, true, at(s));   // 0.5 m every 5 s
  }

  ASSERT_EQ(watch.stuck(at(10), seconds(8)).size(), 1U);
  EXPECT_EQ(watch.stuck(at(10), seconds(8))[0].robot, RobotId(0));
  watch.reset_stuck_timers(at(10));
  EXPECT_TRUE(watch.stuck(at(10), seconds(8)).empty());
}

}  // namespace
}  // namespace swarm::planner
