// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The plan's clock as the keeper of the plan runs it.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/unit/planner_service/keeper_bench.hpp"

namespace swarm::planner {
namespace {

using test::has;
using Bench = test::KeeperBench;

TEST(PlanKeeperClock, RunsWithTheMissionAndStopsInAPause) {
  Bench bench;
  bench.run_for(3);
  EXPECT_EQ(bench.keeper.clock(bench.utc).plan_time_s, 0.0);
  EXPECT_EQ(bench.keeper.clock(bench.utc).rate, 0.0);

  bench.keeper.set_phase(MissionPhase::kRunning);
  bench.run_for(5);
  const double running_s = bench.keeper.clock(bench.utc).plan_time_s;
  EXPECT_NEAR(running_s, 4.9, 1e-9);  // from the first step after the start

  bench.keeper.set_phase(MissionPhase::kPaused);
  bench.run_for(5);
  EXPECT_NEAR(bench.keeper.clock(bench.utc).plan_time_s, running_s, 1e-9);
}

/// Published and recorded readings are those of the clock: they interpolate to it.
TEST(PlanKeeperClock, ItsReadingsAreTheClock) {
  Bench bench;
  bench.keeper.set_phase(MissionPhase::kRunning);
  for (const double lag_s : {0.0, 5.0, 3.5, 20.0, 1.0}) {
    bench.lag_s = lag_s;
    bench.run_for(7.3);
    const PlanClock* reading = clock_at(bench.readings, bench.utc);
    ASSERT_NE(reading, nullptr);
    EXPECT_NEAR(reading->plan_time_at_s(bench.utc), bench.keeper.clock(bench.utc).plan_time_s,
                0.051);
  }
}

TEST(PlanKeeperClock, WaitsForASwarmThatIsBehindAndReportsIt) {
  Bench bench;
  bench.keeper.set_phase(MissionPhase::kRunning);
  bench.lag_s = 5.0;
  bench.run_for(3);
  EXPECT_DOUBLE_EQ(bench.keeper.clock(bench.utc).rate, 0.5);
  EXPECT_FALSE(has(bench.notices, "plan-clock-slow"));  // not yet
  bench.run_for(5);
  EXPECT_TRUE(has(bench.notices, "plan-clock-slow"));

  bench.lag_s = 0.0;
  bench.run_for(2);
  EXPECT_DOUBLE_EQ(bench.keeper.clock(bench.utc).rate, 1.0);
  EXPECT_TRUE(has(bench.notices, "plan-clock-full"));
}

TEST(PlanKeeperClock, NamesTheHopelessOnce) {
  Bench bench;
  bench.keeper.set_phase(MissionPhase::kRunning);
  bench.lag_s = 31.0;
  bench.run_for(10);
  EXPECT_EQ(std::count_if(bench.notices.begin(), bench.notices.end(),
                          [](const auto& notice) { return notice.code == "robots-late"; }),
            1);
}

TEST(PlanKeeperClock, GoesOnAfterARestartWhereTheRobotsAre) {
  Bench bench;
  bench.keeper.set_phase(MissionPhase::kRunning);
  bench.robots_plan_time_s = 40.0;
  bench.run_for(1.5);
  EXPECT_GE(bench.keeper.clock(bench.utc).plan_time_s, 40.0);
  EXPECT_LE(bench.keeper.clock(bench.utc).plan_time_s, 41.5);
}

// Heartbeats went on while the keeper planned; a pause that arrived meanwhile stops its clock.
TEST(PlanKeeperClock, DoesNotGoBackBehindWhatTheRobotsHave) {
  Bench bench;
  bench.keeper.set_phase(MissionPhase::kRunning);
  bench.run_for(5);
  const PlanClock before = bench.keeper.clock(bench.utc);
  bench.keeper.set_phase(MissionPhase::kPaused);
  bench.keeper.on_published(
      {.plan_version = before.plan_version, .plan_time_s = before.plan_time_s + 3.0, .rate = 1.0});
  bench.step_after(std::chrono::seconds(4));
  EXPECT_DOUBLE_EQ(bench.keeper.clock(bench.utc).plan_time_s, before.plan_time_s + 3.0);
  EXPECT_EQ(bench.keeper.clock(bench.utc).rate, 0.0);
  ASSERT_FALSE(bench.readings.empty());
  EXPECT_DOUBLE_EQ(bench.readings.back().plan_time_s, before.plan_time_s + 3.0);

  bench.keeper.on_published({.plan_version = 99, .plan_time_s = 1000.0, .rate = 1.0});
  bench.run_for(1);
  EXPECT_DOUBLE_EQ(bench.keeper.clock(bench.utc).plan_time_s, before.plan_time_s + 3.0)
      << "of another plan";
}

TEST(PlanKeeperClock, StartsOverWithANewPlan) {
  Bench bench;
  bench.keeper.set_phase(MissionPhase::kRunning);
  bench.run_for(6);
  bench.step_after(SetRisk{0.04});
  bench.run_for(0.4);

  EXPECT_EQ(bench.keeper.version(), 2U);
  EXPECT_EQ(bench.keeper.clock(bench.utc).plan_version, 2U);
  EXPECT_LT(bench.keeper.clock(bench.utc).plan_time_s, 0.5);
}

}  // namespace
}  // namespace swarm::planner
