// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Restarts of the planner.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/swarm_launcher/supervision/supervisor_bench.hpp"

namespace swarm::launcher {
namespace {

TEST(Supervisor, RestartsAPlannerThatCrashedButNotOneThatCannotPlan) {
  RunningBench crashed(3);
  crashed.start();
  crashed.sut->on_exit(kPlanner, {.code = 0, .signal = 9}, crashed.now);
  crashed.run_for(seconds(1));
  EXPECT_EQ(std::count(crashed.started.begin(), crashed.started.end(), 0U), 2);
  EXPECT_EQ(crashed.sut->stage(), Supervisor::Stage::kRunning);

  SupervisorBench infeasible(3);
  infeasible.run_for(milliseconds(200));
  infeasible.sut->on_exit(kPlanner, {.code = 1, .signal = 0}, infeasible.now);
  infeasible.run_for(seconds(1));
  EXPECT_EQ(infeasible.sut->outcome(), Outcome::kPlannerFailed);
}

// Robots without a planner hold: that is no reason to end their processes.
TEST(Supervisor, RestartsAPlannerThatKeepsCrashingInFlightEverMoreSlowly) {
  RunningBench bench(3);
  bench.options.launcher.time_limit_s = 1e6;
  bench.start();
  const auto starts = [&] { return std::count(bench.started.begin(), bench.started.end(), 0U); };
  for (int deaths = 1; deaths <= 10; ++deaths) {
    const auto before = starts();
    bench.sut->on_exit(kPlanner, {.code = 0, .signal = 11}, bench.now);
    const double delay_s = std::min(30.0, 0.3 * std::pow(2.0, deaths - 1));
    bench.run_for(milliseconds(static_cast<int>(1000 * delay_s) - 100));
    ASSERT_EQ(starts(), before) << deaths;
    bench.run_for(milliseconds(200));
    ASSERT_EQ(starts(), before + 1) << deaths;
    ASSERT_EQ(bench.sut->stage(), Supervisor::Stage::kRunning);
  }
}

TEST(Supervisor, ForgetsTheDeathsOfAPlannerThatWasWell) {
  RunningBench bench(3);
  bench.options.launcher.time_limit_s = 1e6;
  bench.start();
  const auto starts = [&] { return std::count(bench.started.begin(), bench.started.end(), 0U); };
  for (int deaths = 1; deaths <= 20; ++deaths) {
    bench.planner_epoch = static_cast<std::uint64_t>(deaths);
    bench.run_for(seconds(30));
    bench.sut->on_exit(kPlanner, {.code = 0, .signal = 11}, bench.now);
    bench.run_for(milliseconds(400));
    ASSERT_EQ(starts(), 1 + deaths);
  }
}

TEST(RestartPolicy, CountsADeathAfterASilenceAsOneInARow) {
  RestartPolicy sut;
  SteadyTime now{seconds(1000)};
  for (std::uint32_t deaths = 1; deaths <= 4; ++deaths) {  // it hangs at each start
    sut.on_start(now);
    now += seconds(30);
    sut.on_exit(now, seconds(30));
    EXPECT_EQ(sut.deaths_in_a_row(), deaths);
  }
  sut.on_start(now);
  now += seconds(60);
  EXPECT_EQ(sut.on_exit(now, seconds(10)), RestartPolicy::kFirstDelay) << "it was well for 50 s";
}

TEST(Supervisor, EndsBeforeTheStartWhenThePlannerKeepsCrashing) {
  SupervisorBench bench(3);
  bench.run_for(milliseconds(200));
  for (int deaths = 1; deaths <= 4; ++deaths) {
    bench.sut->on_exit(kPlanner, {.code = 0, .signal = 11}, bench.now);
    bench.run_for(seconds(3));
  }
  EXPECT_EQ(bench.sut->outcome(), Outcome::kPlannerFailed);
}

}  // namespace
}  // namespace swarm::launcher
