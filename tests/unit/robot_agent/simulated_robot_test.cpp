// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/drivers/simulated_robot.hpp"

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;
SteadyTime at(int ms) { return SteadyTime(milliseconds(ms)); }

TEST(SimulatedRobot, MovesWithItsCommand) {
  SimulatedRobot sut(at(0), {1, 1});
  sut.command(at(0), {1, -2}, milliseconds(200));

  const Measurement m = sut.measure(at(100));

  EXPECT_NEAR(m.position_m.x(), 1.1, 1e-12);
  EXPECT_NEAR(m.position_m.y(), 0.8, 1e-12);
  EXPECT_FALSE(m.command_expired);
}

TEST(SimulatedRobot, StopsByItselfWhenTheCommandRunsOut) {
  SimulatedRobot sut(at(0), {0, 0});
  sut.command(at(0), {1, 0}, milliseconds(200));

  const Measurement late = sut.measure(at(1000));

  EXPECT_NEAR(late.position_m.x(), 0.2, 1e-12);
  EXPECT_TRUE(late.command_expired);
  EXPECT_EQ(late.expired_at, at(200));
  EXPECT_FALSE(sut.measure(at(1100)).command_expired);
}

}  // namespace
}  // namespace swarm::agent
