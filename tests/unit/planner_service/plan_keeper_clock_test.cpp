// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The plan's clock as the keeper of the plan runs it.
#include <algorithm>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "planner_service/plan_keeper.hpp"
#include "swarm_core/mission/mission_file.hpp"
#include "swarm_core/mission/placement.hpp"

namespace swarm::planner {
namespace {

SteadyTime no_time() { return {}; }

/// A keeper whose robots are where they were placed, at `lag_s` and, by their own clock, `ahead_s`
/// ahead of the keeper's.
struct Bench {
  Mission mission;
  std::optional<PlanKeeper> keeper;
  SteadyTime now{std::chrono::seconds(100)};
  UtcTime utc{std::chrono::seconds(100)};
  std::vector<Vec2> positions_m;
  double lag_s = 0.0;
  double robots_plan_time_s = 0.0;
  std::uint32_t robots_version = 1;
  std::vector<PlanClock> readings;
  std::vector<PlanKeeper::Notice> notices;

  Bench()
      : mission(load_mission(std::filesystem::path(SWARM_SOURCE_DIR) / "deploy/missions/small.yaml")
                    .value()),
        positions_m(place_robots(mission, 1).value()) {
    keeper.emplace(mission, 1, &no_time);
    EXPECT_TRUE(keeper->plan_first().has_value());
    keeper->begin(now - std::chrono::seconds(10));
    keeper->take_scene(first_scene(mission.world.obstacles().size()));
  }

  void run_for(double time_s) {
    for (int i = 0; i < static_cast<int>(time_s * 10.0 + 0.5); ++i) {
      now += std::chrono::milliseconds(100);
      utc += std::chrono::milliseconds(100);
      for (std::uint32_t r = 0; r < positions_m.size(); ++r) {
        keeper->hear({.robot = RobotId(r),
                      .position_m = positions_m[r],
                      .lag_s = lag_s,
                      .plan_version = robots_version,
                      .plan_time_s = robots_plan_time_s},
                     true, now);
      }
      const PlanKeeper::Step step = keeper->step(now, utc);
      if (step.clock) readings.push_back(*step.clock);
      notices.insert(notices.end(), step.notices.begin(), step.notices.end());
    }
  }
  bool noticed(const std::string& code) const {
    return std::any_of(notices.begin(), notices.end(),
                       [&](const PlanKeeper::Notice& notice) { return notice.code == code; });
  }
};

TEST(PlanKeeperClock, RunsWithTheMissionAndStandsStillInAPause) {
  Bench bench;
  bench.run_for(3);
  EXPECT_EQ(bench.keeper->clock(bench.utc).plan_time_s, 0.0);
  EXPECT_EQ(bench.keeper->clock(bench.utc).rate, 0.0);

  bench.keeper->set_phase(MissionPhase::kRunning);
  bench.run_for(5);
  const double running_s = bench.keeper->clock(bench.utc).plan_time_s;
  EXPECT_NEAR(running_s, 4.9, 1e-9);  // from the first step on that knows of the start

  bench.keeper->set_phase(MissionPhase::kPaused);
  bench.run_for(5);
  EXPECT_NEAR(bench.keeper->clock(bench.utc).plan_time_s, running_s, 1e-9);
}

/// What is written down and told is the clock: its readings interpolate to it.
TEST(PlanKeeperClock, ItsReadingsAreTheClock) {
  Bench bench;
  bench.keeper->set_phase(MissionPhase::kRunning);
  for (const double lag_s : {0.0, 5.0, 3.5, 20.0, 1.0}) {
    bench.lag_s = lag_s;
    bench.run_for(7.3);
    const PlanClock* reading = clock_at(bench.readings, bench.utc);
    ASSERT_NE(reading, nullptr);
    EXPECT_NEAR(reading->plan_time_at_s(bench.utc), bench.keeper->clock(bench.utc).plan_time_s,
                0.051);
  }
}

TEST(PlanKeeperClock, WaitsForASwarmThatIsBehindAndSaysSo) {
  Bench bench;
  bench.keeper->set_phase(MissionPhase::kRunning);
  bench.lag_s = 5.0;
  bench.run_for(3);
  EXPECT_DOUBLE_EQ(bench.keeper->clock(bench.utc).rate, 0.5);
  EXPECT_FALSE(bench.noticed("plan-clock-slow"));  // not yet
  bench.run_for(5);
  EXPECT_TRUE(bench.noticed("plan-clock-slow"));

  bench.lag_s = 0.0;
  bench.run_for(2);
  EXPECT_DOUBLE_EQ(bench.keeper->clock(bench.utc).rate, 1.0);
  EXPECT_TRUE(bench.noticed("plan-clock-full"));
}

TEST(PlanKeeperClock, NamesTheHopelessOnce) {
  Bench bench;
  bench.keeper->set_phase(MissionPhase::kRunning);
  bench.lag_s = 31.0;
  bench.run_for(10);
  EXPECT_EQ(std::count_if(bench.notices.begin(), bench.notices.end(),
                          [](const auto& notice) { return notice.code == "robots-late"; }),
            1);
}

TEST(PlanKeeperClock, GoesOnAfterARestartWhereTheRobotsAre) {
  Bench bench;
  bench.keeper->set_phase(MissionPhase::kRunning);
  bench.robots_plan_time_s = 40.0;
  bench.run_for(1.5);
  EXPECT_GE(bench.keeper->clock(bench.utc).plan_time_s, 40.0);
  EXPECT_LE(bench.keeper->clock(bench.utc).plan_time_s, 41.5);
}

TEST(PlanKeeperClock, StartsOverWithANewPlan) {
  Bench bench;
  bench.keeper->set_phase(MissionPhase::kRunning);
  bench.run_for(6);
  Scene scene = first_scene(bench.mission.world.obstacles().size());
  scene = after(scene, SetRisk{0.04}, bench.mission.world, bench.utc).value();
  bench.keeper->take_scene(scene);
  bench.run_for(0.5);

  EXPECT_EQ(bench.keeper->version(), 2U);
  EXPECT_EQ(bench.keeper->clock(bench.utc).plan_version, 2U);
  EXPECT_LT(bench.keeper->clock(bench.utc).plan_time_s, 0.5);
}

}  // namespace
}  // namespace swarm::planner
