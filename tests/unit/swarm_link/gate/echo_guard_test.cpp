// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/gate/echo_guard.hpp"

#include <gtest/gtest.h>

namespace swarm::link {
namespace {

RobotStateMessage numbered(std::uint32_t number) {
  return {.robot_id = 3, .sequence_number = number, .stamp_utc_ns = 1000 + number};
}

TEST(EchoGuard, KnowsTheLast64StatesOfARobot) {
  EchoGuard sut;
  for (std::uint32_t number = 1; number <= 100; ++number) sut.record_sent(numbered(number));

  EXPECT_TRUE(sut.is_echo(numbered(100)));
  EXPECT_TRUE(sut.is_echo(numbered(37)));
  EXPECT_FALSE(sut.is_echo(numbered(36)));
  EXPECT_FALSE(sut.is_echo(numbered(101)));
}

TEST(EchoGuard, AsksForNumberAndStamp) {
  EchoGuard sut;
  sut.record_sent(numbered(5));
  RobotStateMessage forged = numbered(5);
  forged.stamp_utc_ns += 1;
  EXPECT_FALSE(sut.is_echo(forged));
}

}  // namespace
}  // namespace swarm::link
