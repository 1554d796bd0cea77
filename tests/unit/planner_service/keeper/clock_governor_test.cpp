// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/keeper/clock_governor.hpp"

#include <gtest/gtest.h>

namespace swarm::planner {
namespace {

SteadyTime at_s(double s) { return SteadyTime(from_seconds(1000.0 + s)); }

/// `late` of ten robots are `lag_s` behind, the others in time.
std::vector<RobotLag> ten_robots(int late, double lag_s) {
  std::vector<RobotLag> robots;
  for (int i = 0; i < 10; ++i) {
    robots.push_back({RobotId(static_cast<std::uint32_t>(i)), i < late ? lag_s : 0.0, false});
  }
  return robots;
}

ClockGovernor running() {
  ClockGovernor sut(PlanClockSpec{});
  sut.issue(1, at_s(0));
  sut.advance(at_s(0), true);
  return sut;
}

TEST(ClockGovernor, StartsAtZeroAndRunsWithTheMission) {
  ClockGovernor sut(PlanClockSpec{});
  sut.issue(1, at_s(0));
  sut.advance(at_s(5), false);  // all robots wait for the start
  EXPECT_EQ(sut.plan_time_s(), 0.0);
  EXPECT_EQ(sut.rate(), 0.0);

  sut.advance(at_s(6), true);
  EXPECT_EQ(sut.plan_time_s(), 0.0);
  sut.advance(at_s(8), true);
  EXPECT_DOUBLE_EQ(sut.plan_time_s(), 2.0);
  EXPECT_EQ(sut.rate(), 1.0);

  sut.advance(at_s(9), false);  // paused
  sut.advance(at_s(20), false);
  EXPECT_DOUBLE_EQ(sut.plan_time_s(), 2.0);
  sut.issue(2, at_s(21));
  EXPECT_EQ(sut.plan_time_s(), 0.0);
}

TEST(ClockGovernor, SlowsDownWhenAQuarterIsBehind) {
  ClockGovernor sut = running();
  sut.judge(ten_robots(2, 20));
  EXPECT_EQ(sut.rate(), 1.0);
  sut.judge(ten_robots(4, 5));  // (5 − 2)/(8 − 2)
  EXPECT_DOUBLE_EQ(sut.rate(), 0.5);
  sut.advance(at_s(4), true);
  EXPECT_DOUBLE_EQ(sut.plan_time_s(), 2.0);
}

TEST(ClockGovernor, KeepsALeastRate) {
  ClockGovernor sut = running();
  sut.judge(ten_robots(10, 25));
  EXPECT_DOUBLE_EQ(sut.rate(), 0.2);
}

TEST(ClockGovernor, DoesNotWaitForTheHopelessAndNamesThem) {
  ClockGovernor sut = running();
  sut.judge(ten_robots(4, 31));
  EXPECT_EQ(sut.rate(), 1.0);
  EXPECT_EQ(sut.hopeless(), (std::vector<RobotId>{RobotId(0), RobotId(1), RobotId(2), RobotId(3)}));
}

TEST(ClockGovernor, ArrivedRobotsAreInTime) {
  ClockGovernor sut = running();
  std::vector<RobotLag> robots = ten_robots(10, 8);
  for (std::size_t i = 0; i < 8; ++i) robots[i].arrived = true;
  sut.judge(robots);
  EXPECT_EQ(sut.rate(), 1.0);
}

TEST(ClockGovernor, ContinuesWhereTheRobotsAreAndNeverGoesBack) {
  ClockGovernor sut = running();
  sut.catch_up(40.0);
  EXPECT_EQ(sut.plan_time_s(), 40.0);
  sut.catch_up(30.0);
  EXPECT_EQ(sut.plan_time_s(), 40.0);
}

TEST(ClockGovernor, AReadingExtrapolates) {
  ClockGovernor sut = running();
  sut.judge(ten_robots(4, 5));
  sut.advance(at_s(4), true);
  const UtcTime now{std::chrono::seconds(77)};
  const PlanClock reading = sut.reading(now);

  EXPECT_EQ(reading.plan_version, 1U);
  EXPECT_DOUBLE_EQ(reading.plan_time_at_s(now + std::chrono::seconds(2)), 3.0);
}

}  // namespace
}  // namespace swarm::planner
