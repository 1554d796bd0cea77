// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Reasons for the end of a run, and how its processes are ended.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/unit/swarm_launcher/supervision/supervisor_bench.hpp"

namespace swarm::launcher {
namespace {

constexpr RobotReport kHasStopped{
    .has_plan = true, .mode = RobotMode::kStopped, .confirms_stop = true};

TEST(Supervisor, NamesWhoIsMissingAndGivesUp) {
  SupervisorBench bench(5);
  bench.run_for(seconds(1));
  for (const std::uint32_t i : {0U, 2U})
    bench.sut->on_status(RobotId(i), {true, true, RobotMode::kWaiting, false});

  bench.run_for(seconds(35));

  EXPECT_TRUE(bench.logged("1, 3-4"));
  EXPECT_EQ(bench.sut->outcome(), Outcome::kQuorumTimeout);
  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kDone);
  EXPECT_LT(bench.sut->discovery_s(), 0.0);
}

TEST(Supervisor, NamesWhyTheMissingRobotsAreNotReady) {
  SupervisorBench bench(6, 2);
  bench.run_for(seconds(1));
  for (std::uint32_t i = 0; i < 6; ++i) {
    bench.sut->on_status(RobotId(i), {true, i < 2, RobotMode::kWaiting, false});
  }
  bench.sut->on_hindered(RobotId(0), "a reason that is over");
  bench.sut->on_hindered(RobotId(4), "no more files");
  bench.run_for(seconds(35));

  EXPECT_TRUE(
      bench.logged("quorum: 4 of 6 robots are not ready after 30 s: 2-5; 4-5: no more files"))
      << bench.log.back();
}

TEST(Supervisor, EndsWhenAllHaveSettled) {
  RunningBench bench(5);
  bench.start();

  bench.report_all(RobotMode::kArrived, true);
  bench.run_for(seconds(1));
  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kRunning) << "one may be pushed out again";
  bench.run_for(seconds(2));

  EXPECT_EQ(bench.sut->outcome(), Outcome::kCompleted);
  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kDone);
}

TEST(Supervisor, CountsARobotThatStoppedItselfAsLost) {
  RunningBench bench(3);
  bench.start();

  bench.report_all(RobotMode::kArrived, true);
  bench.sut->on_status(RobotId(1), {true, true, RobotMode::kStopped});
  bench.run_for(seconds(4));

  EXPECT_EQ(bench.sut->outcome(), Outcome::kCompleted);
  EXPECT_EQ(bench.sut->counts().arrived, 2U);
  EXPECT_EQ(bench.sut->lost(), std::vector<RobotId>{RobotId(1)});
}

TEST(Supervisor, RepeatsAStopAndNamesWhoHasNotConfirmed) {
  RunningBench bench(4);
  bench.start();
  for (const std::uint32_t i : {0U, 1U, 3U}) bench.sut->on_status(RobotId(i), kHasStopped);
  bench.sut->on_status(RobotId(2), {.has_plan = true, .mode = RobotMode::kStopped});
  bench.sut->on_status(RobotId(3), {.has_plan = true, .mode = RobotMode::kStopped});

  bench.sut->on_command(CommandKind::kStop, bench.now);
  bench.run_for(seconds(6));

  EXPECT_EQ(std::count(bench.commands.begin(), bench.commands.end(), CommandKind::kStop), 15);
  EXPECT_TRUE(bench.logged("not confirmed by 2"));
  EXPECT_EQ(bench.sut->outcome(), Outcome::kStopped);
}

TEST(Supervisor, ClimbsTheLadderOfSignals) {
  RunningBench bench(2);
  bench.start();
  bench.obedient = false;

  bench.sut->on_interrupt();
  bench.run_for(milliseconds(100));
  EXPECT_EQ(bench.signals.size(), 3U);
  EXPECT_EQ(bench.signals.back().second, EndSignal::kInterrupt);
  bench.run_for(seconds(5));
  EXPECT_EQ(bench.signals.back().second, EndSignal::kTerminate);
  bench.run_for(seconds(5));
  EXPECT_EQ(bench.signals.back().second, EndSignal::kKill);
  for (std::uint32_t i = 0; i < 3; ++i)
    bench.sut->on_exit(ProcessIndex(i), {.code = 0, .signal = 9}, bench.now);
  bench.run_for(milliseconds(100));

  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kDone);
  EXPECT_EQ(bench.sut->outcome(), Outcome::kInterrupted);
}

TEST(Supervisor, StopsStartingWhenInterrupted) {
  SupervisorBench bench(100);
  bench.run_for(milliseconds(500));
  const std::size_t started = bench.started.size();

  bench.sut->on_interrupt();
  bench.run_for(seconds(1));

  EXPECT_EQ(bench.started.size(), started);
  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kDone);
}

TEST(Supervisor, KillsAtTheSecondInterrupt) {
  RunningBench bench(2);
  bench.start();
  bench.obedient = false;

  bench.sut->on_interrupt();
  bench.run_for(milliseconds(100));
  bench.sut->on_interrupt();
  bench.run_for(milliseconds(100));

  EXPECT_EQ(bench.signals.back().second, EndSignal::kKill);
}

TEST(Supervisor, EndsAtTheTimeLimit) {
  RunningBench bench(2);
  bench.options.launcher.time_limit_s = 5.0;
  bench.start();

  bench.run_for(seconds(6));

  EXPECT_EQ(bench.sut->outcome(), Outcome::kTimeLimit);
}

}  // namespace
}  // namespace swarm::launcher
