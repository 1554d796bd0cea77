// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission/fleet.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm {
namespace {

RobotGroupSpec group(std::uint32_t count, double radius_m, double speed_max_mps) {
  RobotGroupSpec g;
  g.count = count;
  g.radius_m = radius_m;
  g.speed_max_mps = speed_max_mps;
  return g;
}

TEST(Fleet, HasTheSameBodyForAllWithoutGroups) {
  const Fleet some(Fleet::Body{0.3, 2.0});
  for (const std::uint32_t id : {0U, 1U, 199'999U}) {
    EXPECT_EQ(Fleet().of(RobotId(id)).radius_m, 0.2);
    EXPECT_EQ(Fleet().of(RobotId(id)).speed_max_mps, 1.5);
    EXPECT_EQ(some.of(RobotId(id)).radius_m, 0.3);
    EXPECT_EQ(some.of(RobotId(id)).speed_max_mps, 2.0);
  }
}

TEST(Fleet, GivesGroupsTheFirstIdsInOrder) {
  RobotsSpec robots;
  robots.count = 10;
  robots.radius_m = 0.9;
  robots.groups = {group(2, 0.1, 1), group(3, 0.2, 2)};
  const Fleet sut(robots);

  for (std::uint32_t id = 0; id < 10; ++id) {
    EXPECT_EQ(sut.of(RobotId(id)).radius_m, id < 2 ? 0.1 : id < 5 ? 0.2 : 0.9) << id;
  }
}

// The launcher and the programs look bodies up in the mission, robots in the fleet.
TEST(Fleet, AgreesWithTheMission) {
  Rng rng(1);
  for (int round = 0; round < 100; ++round) {
    RobotsSpec robots;
    robots.count = 0;
    robots.radius_m = uniform(rng, 0.1, 1);
    robots.speed_max_mps = uniform(rng, 0.1, 3);
    double largest_m = robots.radius_m;
    for (std::uint64_t i = rng() % 6; i > 0; --i) {
      robots.groups.push_back(group(static_cast<std::uint32_t>(rng() % 5 + 1), uniform(rng, 0.1, 1),
                                    uniform(rng, 0.1, 3)));
      robots.count += robots.groups.back().count;
      largest_m = std::max(largest_m, robots.groups.back().radius_m);
    }
    robots.count += static_cast<std::uint32_t>(rng() % 5 + 1);
    const Fleet sut(robots);
    for (std::uint32_t id = 0; id < robots.count; ++id) {
      EXPECT_EQ(sut.of(RobotId(id)).radius_m, body_of(robots, RobotId(id)).radius_m);
      EXPECT_EQ(sut.of(RobotId(id)).speed_max_mps, body_of(robots, RobotId(id)).speed_max_mps);
    }
    EXPECT_EQ(largest_radius_m(robots), largest_m);
  }
}

TEST(LargestCommunicationRadius, IsThatOfAnyBodyOrTheLink) {
  Mission mission;
  mission.link.communication_radius_m = 4;
  EXPECT_EQ(largest_communication_radius_m(mission), 4);
  mission.robots.groups = {group(1, 0.2, 1), group(1, 0.2, 1)};
  mission.robots.groups[1].communication_radius_m = 7;
  EXPECT_EQ(largest_communication_radius_m(mission), 7);
  mission.robots.communication_radius_m = 9;
  EXPECT_EQ(largest_communication_radius_m(mission), 9);
}

}  // namespace
}  // namespace swarm
