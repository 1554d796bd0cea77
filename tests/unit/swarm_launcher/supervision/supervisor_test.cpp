// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/supervision/supervisor.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/unit/swarm_launcher/supervision/supervisor_bench.hpp"

namespace swarm::launcher {
namespace {

TEST(Supervisor, StartsThePlannerThenAgentsInWaves) {
  SupervisorBench bench(30);
  bench.options.launcher.starting_max = 30;

  bench.run_for(milliseconds(1000));

  EXPECT_EQ(bench.started.front(), 0U);
  EXPECT_GE(bench.started.size(), 10U);
  EXPECT_LE(bench.started.size(), 12U);
}

TEST(Supervisor, WaitsForTheStartedBeforeItStartsMore) {
  SupervisorBench bench(30);
  bench.options.launcher.starting_max = 4;

  bench.run_for(milliseconds(2000));
  EXPECT_EQ(bench.started.size(), 1U + 4U);

  bench.sut->on_status(RobotId(1), {});
  bench.run_for(milliseconds(100));
  EXPECT_EQ(bench.started.size(), 1U + 5U);
}

TEST(Supervisor, DoesNotWaitLongForAProcessThatHangs) {
  SupervisorBench bench(8);
  bench.options.launcher.starting_max = 4;

  bench.run_for(seconds(8));

  EXPECT_EQ(bench.started.size(), 1U + 8U);
}

TEST(Supervisor, StartsTheMissionWhenEveryRobotIsReady) {
  SupervisorBench bench(5);
  bench.run_for(seconds(1));
  EXPECT_TRUE(bench.commands.empty());

  bench.report_all(RobotMode::kWaiting);
  bench.run_for(milliseconds(100));

  ASSERT_EQ(bench.commands.size(), 1U);
  EXPECT_EQ(bench.commands[0], CommandKind::kStart);
  EXPECT_GE(bench.sut->discovery_s(), 0.0);
}

TEST(Supervisor, LeavesRemoteRobotsToOtherHosts) {
  SupervisorBench bench(4);
  bench.options.remote_processes = 2;
  bench.run_for(seconds(1));
  EXPECT_EQ(bench.started.size(), 3U) << "the planner and two agents";
  bench.report_all(RobotMode::kWaiting);
  bench.sut->on_joined(ProcessIndex(3), 2, bench.now);
  bench.run_for(milliseconds(100));
  ASSERT_EQ(bench.commands.size(), 1U);

  bench.sut->on_exit(ProcessIndex(4), {}, bench.now);
  bench.run_for(seconds(2));

  EXPECT_EQ(bench.started.size(), 3U) << "another host's process is not ours to start again";
  EXPECT_EQ(bench.sut->lost(), std::vector<RobotId>{RobotId(3)});
}

TEST(Supervisor, GoesOnWithoutAHostThatNeverCame) {
  SupervisorBench bench(4);
  bench.options.remote_processes = 1;
  bench.options.launcher.quorum_timeout_s = 5.0;
  bench.options.launcher.quorum_share = 0.5;
  bench.run_for(seconds(1));
  for (std::uint32_t i = 0; i < 3; ++i) {
    bench.sut->on_status(RobotId(i), {true, true, RobotMode::kWaiting, false});
  }
  bench.run_for(seconds(5));

  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kRunning);
  EXPECT_EQ(bench.sut->lost(), std::vector<RobotId>{RobotId(3)});
}

TEST(Supervisor, WaitsUntilEveryRobotReceivesItsNeighbours) {
  SupervisorBench bench(3);
  bench.run_for(seconds(1));
  for (std::uint32_t i = 0; i < 3; ++i) {
    bench.sut->on_status(RobotId(i), {true, i != 1, RobotMode::kWaiting, false});
  }
  bench.run_for(seconds(1));
  EXPECT_TRUE(bench.commands.empty());
  EXPECT_GE(bench.sut->discovery_s(), 0.0);

  bench.report_all(RobotMode::kWaiting);
  bench.run_for(milliseconds(100));

  EXPECT_EQ(bench.commands.size(), 1U);
  EXPECT_GE(bench.sut->neighbour_discovery_s(), 0.9);
}

// Neighbours at the rim of the communication radius come and go, as robots that wait make room.
TEST(Supervisor, TakesARobotForReadyThatHasReceivedAllNeighboursOnce) {
  SupervisorBench bench(3);
  bench.run_for(seconds(1));
  const auto report = [&](std::uint32_t without) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      bench.sut->on_status(RobotId(i), {true, i != without, RobotMode::kWaiting, false});
    }
    bench.run_for(seconds(1));
  };
  report(0);
  EXPECT_TRUE(bench.commands.empty());
  report(1);

  EXPECT_EQ(bench.commands.size(), 1U);
}

// While others are not known yet, a robot seems to have no neighbours.
TEST(Supervisor, DoesNotCountNeighboursBeforeAllRobotsAreKnown) {
  SupervisorBench bench(3);
  bench.run_for(seconds(1));
  bench.sut->on_status(RobotId(0), {true, true, RobotMode::kWaiting, false});
  bench.run_for(seconds(1));

  for (std::uint32_t i = 0; i < 3; ++i) {
    bench.sut->on_status(RobotId(i), {true, i != 0, RobotMode::kWaiting, false});
  }
  bench.run_for(seconds(1));

  EXPECT_TRUE(bench.commands.empty());
}

TEST(Supervisor, GoesOnWithAQuorumAfterTheTimeOut) {
  SupervisorBench bench(5);
  bench.options.launcher.quorum_share = 0.8;
  bench.run_for(seconds(1));
  for (std::uint32_t i = 0; i < 4; ++i)
    bench.sut->on_status(RobotId(i), {true, true, RobotMode::kWaiting, false});

  bench.run_for(seconds(31));

  EXPECT_TRUE(bench.logged("not ready"));
  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kRunning);
}

TEST(Supervisor, CountsAKilledAgentAsLostAndFliesOn) {
  RunningBench bench(5);
  bench.start();

  bench.sut->on_exit(ProcessIndex(3), {.code = 0, .signal = 9}, bench.now);
  bench.run_for(seconds(1));
  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kRunning);
  ASSERT_EQ(bench.sut->lost().size(), 1U);
  EXPECT_EQ(bench.sut->lost()[0], RobotId(2));

  bench.report_all(RobotMode::kArrived, true);
  bench.run_for(seconds(3));
  EXPECT_EQ(bench.sut->outcome(), Outcome::kCompleted);
}

TEST(Supervisor, PlaysTheScript) {
  RunningBench bench(2);
  bench.options.script = {
      {1.0, CommandKind::kPause}, {2.0, SetRisk{0.3}}, {3.0, CommandKind::kResume}};
  bench.start();

  bench.run_for(seconds(2));
  EXPECT_EQ(bench.sut->phase(), MissionPhase::kPaused);
  bench.run_for(seconds(2));

  EXPECT_EQ(bench.sut->phase(), MissionPhase::kRunning);
  ASSERT_EQ(bench.changes.size(), 1U);
  EXPECT_EQ(std::get<SetRisk>(bench.changes[0]).alpha, 0.3);
}

TEST(Supervisor, GoesOnUntilEveryoneIsAtTheLastGoalOfTheScript) {
  RunningBench bench(2);
  const Mixture goal = Mixture::make({{1.0, Gaussian{}}}).value();
  bench.options.script = {{10.0, GoTo{goal}}};
  bench.start();

  bench.report_all(RobotMode::kArrived, true);
  bench.run_for(seconds(8));
  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kRunning) << "a goal is still to come";
  bench.run_for(seconds(4));
  ASSERT_EQ(bench.changes.size(), 1U);
  bench.run_for(seconds(20));
  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kRunning) << "at rest by the old plan";
  bench.report_all(RobotMode::kArrived, true, 77);
  bench.run_for(seconds(3));

  EXPECT_EQ(bench.sut->outcome(), Outcome::kCompleted);
}

TEST(Supervisor, SplitsRobotsOverProcesses) {
  SupervisorBench bench(10, 4);
  bench.run_for(seconds(1));

  EXPECT_EQ(bench.sut->processes(), 4U);
  EXPECT_EQ(bench.sut->robots_of(ProcessIndex(3)), std::pair(RobotId(8), 2U));
}

TEST(Describe, NamesRangesAndNotTooMany) {
  std::vector<RobotId> robots = {RobotId(3), RobotId(7), RobotId(8), RobotId(9)};
  EXPECT_EQ(describe(robots), "3, 7-9");

  robots.clear();
  for (std::uint32_t i = 0; i < 100; ++i) robots.emplace_back(2 * i);
  const std::string text = describe(robots);
  EXPECT_LT(text.size(), 120U);
  EXPECT_TRUE(text.ends_with("36, 38 and 80 more")) << text;
}

}  // namespace
}  // namespace swarm::launcher
