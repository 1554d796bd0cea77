// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include <gtest/gtest.h>

#include "swarm_launcher/supervision/fallen_body.hpp"

namespace swarm::launcher {
namespace {

UtcTime at_s(double s) { return UtcTime(from_seconds(100.0 + s)); }

robot_log::Step step(double s, const Vec2& position_m, const Vec2& velocity_mps) {
  return {.stamp = at_s(s), .position_m = position_m, .velocity_mps = velocity_mps};
}

TEST(LastKnown, IsNothingWithoutAStep) { EXPECT_FALSE(last_known({}, Mission{}).has_value()); }

TEST(LastKnown, OfOneStepHasACommandAndNoSpeed) {
  const std::vector<robot_log::Step> log = {step(0.0, {3, 4}, {0.5, 0})};
  const auto known = last_known(log, Mission{});
  ASSERT_TRUE(known);
  EXPECT_EQ(known->at, at_s(0.0));
  EXPECT_EQ(known->position_m, Vec2(3, 4));
  EXPECT_EQ(known->command_mps, Vec2(0.5, 0));
  EXPECT_FALSE(known->speed_mps.has_value());
  EXPECT_FALSE(known->at_rest);
}

TEST(LastKnown, HasTheMeanSpeedOfTheLastPeriodWhateverCameBefore) {
  const std::vector<robot_log::Step> log = {step(0.0, {90, 90}, {0, 0}), step(0.1, {3, 4}, {0, 0}),
                                            step(0.2, {3.03, 4.04}, {1, 1})};
  const auto known = last_known(log, Mission{});
  ASSERT_TRUE(known && known->speed_mps);
  EXPECT_NEAR(*known->speed_mps, 0.5, 1e-9) << "5 cm in 0.1 s";
}

// At 10 Hz the two steps may be 0.3 s apart; a longer gap, or a clock that went back, gives none.
TEST(LastKnown, HasASpeedOnlyFromStepsThatFollowEachOther) {
  const struct {
    double gap_s;
    bool known;
  } cases[] = {{0.1, true},  {0.299, true}, {0.301, false},
               {5.0, false}, {0.0, false},  {-0.1, false}};
  for (const auto& c : cases) {
    const std::vector<robot_log::Step> log = {step(0.0, {3, 4}, {0, 0}),
                                              step(c.gap_s, {3, 4}, {0, 0})};
    EXPECT_EQ(last_known(log, Mission{})->speed_mps.has_value(), c.known) << c.gap_s;
  }
}

// What is not known only ever makes the circle larger.
TEST(CircleOfFallen, ShrinksWithEveryPieceOfInformation) {
  for (const char* model : {"single_integrator", "double_integrator", "unicycle"}) {
    Mission mission;
    mission.robots.model = model;
    const auto radius_m = [&](const LastKnown& known, double age_s) {
      return circle_of_fallen(known, at_s(age_s), mission, RobotId(0)).radius_m;
    };
    for (const double age_s : {0.0, 0.05, 0.1, 0.3}) {
      LastKnown known{.at = at_s(0.0), .position_m = {1, 2}};
      const double by_status_m = radius_m(known, age_s);
      known.command_mps = Vec2(0.5, 0.0);
      known.is_last = true;
      const double by_command_m = radius_m(known, age_s);
      known.speed_mps = 0.5;
      const double by_speed_m = radius_m(known, age_s);
      known.at_rest = true;
      const double at_rest_m = radius_m(known, age_s);
      EXPECT_GE(by_status_m, by_command_m) << model << ", " << age_s << " s";
      EXPECT_GE(by_command_m, by_speed_m) << model << ", " << age_s << " s";
      EXPECT_GE(by_speed_m, at_rest_m) << model << ", " << age_s << " s";
      EXPECT_EQ(at_rest_m, mission.robots.radius_m);
    }
  }
}

}  // namespace
}  // namespace swarm::launcher
