// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission/mission_rules.hpp"

#include <gtest/gtest.h>

namespace swarm {
namespace {

TEST(MissionRules, AllowTheDefaults) {
  const auto broken = broken_rules(Mission{});

  EXPECT_TRUE(broken.empty()) << broken[0].message;
}

TEST(MissionRules, TieTheCommunicationRadiusToTheBrakingDistance) {
  Mission mission;
  mission.robots.radius_m = 0.2;
  mission.robots.speed_max_mps = 1.5;
  mission.control.rate_hz = 10.0;
  mission.safety.gap_share = 0.25;
  mission.safety.neighbour_margin_m = 0.25;
  mission.link.send_interval_max_s = 0.5;

  // By hand: 0.4 + 0.25 + 3.0 · (0.1/0.25 + 0.5).
  EXPECT_NEAR(least_communication_radius_m(mission), 3.35, 1e-12);
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
