// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission/mission_rules.hpp"

#include <gtest/gtest.h>

namespace swarm {
namespace {

/// A mission whose least communication radius is easy to compute by hand.
Mission mission_of_known_braking() {
  Mission mission;
  mission.robots.radius_m = 0.2;
  mission.robots.speed_max_mps = 1.5;
  mission.control.rate_hz = 10.0;
  mission.safety.gap_share = 0.25;
  mission.safety.neighbour_margin_m = 0.25;
  mission.link.send_interval_max_s = 0.5;
  return mission;
}

TEST(MissionRules, AllowTheDefaults) {
  const auto broken = broken_rules(Mission{});

  EXPECT_TRUE(broken.empty()) << broken[0].message;
}

TEST(MissionRules, TieTheCommunicationRadiusToTheBrakingDistance) {
  const Mission mission = mission_of_known_braking();

  // By hand: 0.4 + 0.25 + 3.0 · (0.1/0.25 + 0.5).
  EXPECT_NEAR(least_communication_radius_m(mission, mission.robots), 3.35, 1e-12);
}

// A group that is larger or faster, or has a smaller radius of its own, must receive others in time
// as well.
TEST(MissionRules, TieTheCommunicationRadiusOfEveryBody) {
  Mission mission = mission_of_known_braking();
  mission.link.communication_radius_m = 5.0;
  mission.robots.groups = {{mission.robots, 2}, {mission.robots, 3}};
  ASSERT_TRUE(broken_rules(mission).empty());

  // By hand: 0.4 + 0.2 + 0.25 + (3 + 3) · 0.9 for the fast one, and 4.5 · 0.9 beside it.
  Mission fast = mission;
  fast.robots.groups[1].radius_m = 0.4;
  fast.robots.groups[1].speed_max_mps = 3.0;
  EXPECT_NEAR(least_communication_radius_m(fast, fast.robots.groups[1]), 6.45, 1e-12);
  EXPECT_NEAR(least_communication_radius_m(fast, fast.robots.groups[0]), 4.9, 1e-12);
  const auto too_fast = broken_rules(fast);
  ASSERT_EQ(too_fast.size(), 1U);
  EXPECT_EQ(too_fast[0].message,
            "link.communication_radius_m is 5; must be >= 6.45, from where on the safety filter "
            "needs to know a robot");
  fast.robots.groups[1].communication_radius_m = 6.5;
  EXPECT_TRUE(broken_rules(fast).empty());

  Mission near = mission;
  near.robots.groups[0].communication_radius_m = 3.3;
  const auto too_near = broken_rules(near);
  ASSERT_EQ(too_near.size(), 1U);
  EXPECT_EQ(too_near[0].keys.front(), "robots.groups[0].communication_radius_m");
  EXPECT_EQ(too_near[0].message,
            "robots.groups[0].communication_radius_m is 3.3; must be >= 3.35, from where on the "
            "safety filter needs to know a robot");
  near.robots.groups[0].communication_radius_m = 0.0;
  near.robots.communication_radius_m = 3.3;
  EXPECT_EQ(broken_rules(near).at(0).keys.front(), "robots.communication_radius_m");
}

TEST(MissionRules, NameTheKeysTheyTie) {
  Mission mission;
  mission.planner.speed_mps = 9.0;

  const auto broken = broken_rules(mission);

  ASSERT_EQ(broken.size(), 1U);
  EXPECT_EQ(broken[0].keys.front(), "planner.speed_mps");
}

TEST(MissionRules, CompareKeysOfComponentsWithDefaults) {
  const Components methods{
      {.name = "m",
       .doc = "",
       .options = {{.key = "low_m", .fallback = "1", .doc = "", .at_most = "high_m"},
                   {.key = "high_m", .fallback = "3", .doc = ""}}}};
  OptionValues values;
  EXPECT_TRUE(broken_rules("planner", methods, values).empty());
  values.set("high_m", 0.5);

  const auto broken = broken_rules("planner", methods, values);

  ASSERT_EQ(broken.size(), 1U);
  EXPECT_EQ(broken[0].message, "planner.low_m is 1; must be <= planner.high_m (0.5)");
}

}  // namespace
}  // namespace swarm
