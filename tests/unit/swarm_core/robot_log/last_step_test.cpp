// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/robot_log/last_step.hpp"

#include <string>

#include <gtest/gtest.h>

namespace swarm::robot_log {
namespace {

const LastStep kStep{.robot = RobotId(42),
                     .stamp = UtcTime(Duration(1'796'091'997'671'297'492)),
                     .position_m = {-12.25, 1034.5},
                     .velocity_mps = {0.5, -1.125}};

TEST(LastStep, ComesBackFromItsText) {
  const auto back = parse_last_step(to_text(kStep));

  ASSERT_TRUE(back);
  EXPECT_EQ(back->robot, kStep.robot);
  EXPECT_EQ(back->stamp, kStep.stamp);
  EXPECT_EQ(back->position_m, kStep.position_m);
  EXPECT_EQ(back->velocity_mps, kStep.velocity_mps);
}

TEST(LastStep, OfADamagedTextIsNone) {
  const std::string text = to_text(kStep);
  for (std::size_t length = 0; length < text.size(); ++length) {
    EXPECT_FALSE(parse_last_step(text.substr(0, length))) << length;
  }
  EXPECT_FALSE(parse_last_step(text + " "));
  for (const char* wrong : {"nan", "inf", "1e300", "-2000000"}) {
    std::string other = text;
    other.replace(other.find("1034.5000"), 9, wrong);
    EXPECT_FALSE(parse_last_step(other)) << other;
  }
}

}  // namespace
}  // namespace swarm::robot_log
