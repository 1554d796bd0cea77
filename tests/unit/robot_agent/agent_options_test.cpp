// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "robot_agent/agent.hpp"

namespace swarm::agent {
namespace {

TEST(AgentOptions, AreOneForRobotsWithTheSameBody) {
  Mission mission;
  mission.robots.count = 4;
  mission.robots.groups.emplace_back();
  mission.robots.groups[0].radius_m = 0.5;
  mission.robots.groups[0].count = 2;
  AgentOptionsOf options_of(mission);

  EXPECT_EQ(&*options_of(RobotId(0)), &*options_of(RobotId(1)));
  EXPECT_EQ(&*options_of(RobotId(2)), &*options_of(RobotId(3)));
  EXPECT_NE(&*options_of(RobotId(1)), &*options_of(RobotId(2)));
  EXPECT_EQ(options_of(RobotId(1))->safety.radius_m, 0.5);
}

TEST(AgentOptions, OutliveTheirMaker) {
  Shared<SafetyOptions> safety;
  {
    Mission mission;
    mission.robots.radius_m = 0.7;
    safety = agent_options(mission, RobotId(0)).part(&AgentOptions::safety);
  }

  EXPECT_EQ(safety->radius_m, 0.7);
}

}  // namespace
}  // namespace swarm::agent
