// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Bodies of robots whose process has ended or that are silent.
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/swarm_launcher/supervision/supervisor_bench.hpp"

namespace swarm::launcher {
namespace {

TEST(SupervisorBodies, OfRobotsThatDieTogetherAreAddedAtOnce) {
  RunningBench bench(5);
  bench.start();

  for (const std::uint32_t process : {4U, 2U}) {
    bench.sut->on_exit(ProcessIndex(process), {.code = 0, .signal = 9}, bench.now);
  }
  bench.run_for(seconds(5));

  EXPECT_EQ(bench.fallen, (Robots{{RobotId(3), RobotId(1)}}));
  EXPECT_TRUE(bench.risen.empty());
}

TEST(SupervisorBodies, OfAProcessAreThoseOfAllItsRobots) {
  SupervisorBench bench(6, 3);
  bench.run_for(seconds(1));
  bench.report_all(RobotMode::kWaiting);
  bench.run_for(milliseconds(100));

  bench.sut->on_exit(ProcessIndex(2), {.code = 0, .signal = 9}, bench.now);
  bench.run_for(milliseconds(100));

  EXPECT_EQ(bench.fallen, (Robots{{RobotId(3), RobotId(4), RobotId(5)}}));
}

TEST(SupervisorBodies, StayUntilTheRespawnedRobotReports) {
  RunningBench bench(3);
  bench.options.launcher.respawn_agent_max = 1;
  bench.start();
  const SteadyTime died = bench.now;
  bench.sut->on_exit(ProcessIndex(2), {.code = 0, .signal = 9}, died);
  bench.run_for(milliseconds(100));
  EXPECT_EQ(bench.fallen, (Robots{{RobotId(1)}})) << "at once, not only when it is lost for good";

  bench.sut->on_status(RobotId(1), report_of(died - milliseconds(5)));
  bench.run_for(seconds(1));
  EXPECT_TRUE(bench.risen.empty()) << "sent before it died, received after";
  EXPECT_EQ(std::count(bench.started.begin(), bench.started.end(), 2U), 2);
  bench.sut->on_status(RobotId(1), report_of(bench.now));
  bench.run_for(milliseconds(100));

  EXPECT_EQ(bench.risen, (Robots{{RobotId(1)}}));
  EXPECT_TRUE(bench.sut->lost().empty());
}

TEST(SupervisorBodies, OfOneThatDiesAsSoonAsItReportsIsNotCleared) {
  RunningBench bench(3);
  bench.options.launcher.respawn_agent_max = 1;
  bench.start();
  bench.sut->on_exit(ProcessIndex(2), {.code = 0, .signal = 9}, bench.now);
  bench.run_for(seconds(1));

  bench.sut->on_status(RobotId(1), report_of(bench.now));
  bench.sut->on_exit(ProcessIndex(2), {.code = 0, .signal = 9}, bench.now);
  bench.run_for(seconds(1));

  EXPECT_EQ(bench.fallen, (Robots{{RobotId(1)}, {RobotId(1)}})) << "anew, where it is now";
  EXPECT_TRUE(bench.risen.empty());
}

TEST(SupervisorBodies, OfASilentRobotIsClearedWhenItReports) {
  RunningBench bench(3);
  bench.start();
  bench.sut->on_silent(RobotId(2), bench.now);
  bench.run_for(seconds(1));
  EXPECT_EQ(bench.fallen, (Robots{{RobotId(2)}}));
  EXPECT_TRUE(bench.sut->lost().empty()) << "its process is alive";

  bench.sut->on_status(RobotId(2), report_of(bench.now));
  bench.run_for(seconds(1));

  EXPECT_EQ(bench.risen, (Robots{{RobotId(2)}}));
}

TEST(SupervisorBodies, OfAProcessThatFreezesStandUntilItReportsAgain) {
  RunningBench bench(3);
  bench.options.agent_silence = SilenceLimits{};
  bench.start();
  bench.reporting = {RobotId(0), RobotId(2)};
  bench.run_for(seconds(4));
  EXPECT_EQ(bench.fallen, (Robots{{RobotId(1)}})) << "once";
  EXPECT_EQ(bench.sut->silent(), std::vector{RobotId(1)});
  EXPECT_TRUE(bench.sut->lost().empty()) << "its process is alive";

  bench.sut->on_status(RobotId(1), report_of(bench.now));
  bench.run_for(milliseconds(100));

  EXPECT_EQ(bench.risen, (Robots{{RobotId(1)}}));
  EXPECT_TRUE(bench.sut->silent().empty());
}

TEST(SupervisorBodies, ThatAUserClearedAreNotAmongTheSilent) {
  RunningBench bench(3);
  bench.start();
  bench.sut->on_exit(ProcessIndex(2), {.code = 0, .signal = 9}, bench.now);
  bench.run_for(seconds(1));
  EXPECT_EQ(bench.sut->silent(), std::vector{RobotId(1)});

  bench.sut->on_cleared(RobotId(1));

  EXPECT_TRUE(bench.sut->silent().empty());
}

TEST(SupervisorBodies, AreNoneOfProcessesThatEndWithTheMission) {
  RunningBench bench(3);
  bench.start();

  bench.sut->on_interrupt();
  bench.run_for(seconds(1));

  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kDone);
  EXPECT_TRUE(bench.fallen.empty());
}

}  // namespace
}  // namespace swarm::launcher
