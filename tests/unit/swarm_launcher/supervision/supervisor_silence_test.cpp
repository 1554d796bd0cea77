// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Processes that run and send nothing: frozen ones, and ones that hang while they start.
#include <algorithm>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/swarm_launcher/supervision/supervisor_bench.hpp"

namespace swarm::launcher {
namespace {

/// Four robots in flight, whose statuses and whose planner's heartbeats arrive.
struct SilenceBench : RunningBench {
  explicit SilenceBench(std::uint32_t robots = 4) : RunningBench(robots) {
    options.agent_silence = options.planner_silence = {};
    options.launcher.respawn_agent_max = 1;
    options.launcher.time_limit_s = 1e6;
    planner_epoch = 1;
  }
  void fly() {
    start();
    for (std::uint32_t i = 0; i < options.robots; ++i) reporting.emplace_back(i);
    run_for(seconds(1));
  }
  /// The last robots are on another host; only the first `reporters` of all report in flight.
  void fly_with_other_host(std::uint32_t remote, std::uint32_t reporters) {
    options.remote_processes = remote;
    run_for(seconds(1));
    sut->on_joined(ProcessIndex(1 + options.robots - remote), remote, now);
    report_all(RobotMode::kWaiting);
    run_for(seconds(1));
    ASSERT_EQ(sut->stage(), Supervisor::Stage::kRunning);
    for (std::uint32_t i = 0; i < reporters; ++i) reporting.emplace_back(i);
  }
  void freeze(std::uint32_t robot) { std::erase(reporting, RobotId(robot)); }
  bool is_killed(std::uint32_t process) const {
    return std::find(signals.begin(), signals.end(), std::pair(process, EndSignal::kKill)) !=
           signals.end();
  }
  std::ptrdiff_t starts(std::uint32_t process) const {
    return std::count(started.begin(), started.end(), process);
  }
};

TEST(SupervisorSilence, NamesAnAgentAfterThreeSecondsAndKillsItAfterTen) {
  SilenceBench bench;
  bench.fly();
  bench.freeze(1);
  bench.run_for(milliseconds(2900));
  EXPECT_FALSE(bench.logged("agent-silent"));
  bench.run_for(milliseconds(300));
  EXPECT_TRUE(bench.logged("agent-silent: agent process 2 (robots 1 to 1)"));
  bench.run_for(milliseconds(6700));
  EXPECT_TRUE(bench.signals.empty());
  bench.run_for(milliseconds(300));
  EXPECT_TRUE(bench.is_killed(2));
  EXPECT_TRUE(
      bench.logged("silent-killed: agent process 2 (robots 1 to 1) has sent no status for "
                   "10 s: it is killed"));

  bench.run_for(seconds(1));
  EXPECT_EQ(bench.starts(2), 2) << "then it is a death like any other";
  EXPECT_EQ(bench.fallen, (Robots{{RobotId(1)}, {RobotId(1)}})) << "when silent, when dead";
  EXPECT_TRUE(bench.sut->lost().empty());
}

TEST(SupervisorSilence, LosesAKilledAgentThatMayNotBeRestarted) {
  SilenceBench bench;
  bench.options.launcher.respawn_agent_max = 0;
  bench.fly();
  bench.freeze(1);
  bench.run_for(seconds(11));
  EXPECT_TRUE(bench.is_killed(2));
  EXPECT_EQ(bench.sut->lost(), std::vector{RobotId(1)});
}

TEST(SupervisorSilence, KillsAndRestartsAPlannerWhoseHeartbeatsStop) {
  SilenceBench bench;
  bench.fly();
  bench.planner_epoch = 0;
  bench.run_for(milliseconds(3200));
  EXPECT_TRUE(bench.logged("planner-silent: the planner has sent no heartbeat for 3 s"));
  EXPECT_FALSE(bench.is_killed(0));
  bench.run_for(seconds(7));
  EXPECT_TRUE(bench.is_killed(0));
  bench.run_for(seconds(1));
  EXPECT_EQ(bench.starts(0), 2);

  bench.planner_epoch = 2;
  bench.run_for(seconds(60));
  EXPECT_EQ(bench.starts(0), 2) << "its successor is well";
  EXPECT_EQ(std::ranges::count(bench.signals, std::pair(0U, EndSignal::kKill)), 1);
}

TEST(SupervisorSilence, DoesNotTakeALateHeartbeatForOneOfTheRestartedPlanner) {
  SilenceBench bench;
  bench.fly();
  bench.planner_epoch = 0;
  bench.run_for(milliseconds(10'100));
  ASSERT_TRUE(bench.is_killed(0));
  bench.run_for(seconds(1));
  ASSERT_EQ(bench.starts(0), 2);
  bench.sut->on_heartbeat(1);  // it was under way for long
  bench.run_for(seconds(20));
  EXPECT_EQ(bench.starts(0), 2) << "the new one still plans, and is not silent yet";
}

TEST(SupervisorSilence, KillsARestartedPlannerThatNeverSendsAHeartbeat) {
  SilenceBench bench;
  bench.fly();
  bench.planner_epoch = 0;
  bench.run_for(seconds(11));
  ASSERT_EQ(bench.starts(0), 2);
  bench.run_for(seconds(28));
  EXPECT_EQ(bench.starts(0), 2) << "it may plan for as long as at the start of a run";
  bench.run_for(seconds(5));
  EXPECT_EQ(bench.starts(0), 3);
}

TEST(SupervisorSilence, GivesAPlannerThatNeverSentAHeartbeatTheTimeOfTheStart) {
  SilenceBench bench;
  bench.planner_epoch = 0;
  bench.options.launcher.quorum_timeout_s = 100.0;
  bench.run_for(seconds(90));
  EXPECT_TRUE(bench.signals.empty());
  EXPECT_EQ(bench.sut->outcome(), Outcome::kNone);
}

TEST(SupervisorSilence, StartsAllClocksAnewAfterAGapOfItsOwn) {
  SilenceBench bench;
  bench.fly();
  const auto reporting = std::exchange(bench.reporting, {});
  bench.planner_epoch = 0;
  bench.now += seconds(60);  // suspended: what was sent meanwhile is still in the sockets
  bench.run_for(milliseconds(200));
  bench.reporting = reporting;
  bench.planner_epoch = 1;
  bench.run_for(seconds(20));
  EXPECT_TRUE(bench.signals.empty());
  EXPECT_FALSE(bench.logged("silent"));
}

// A robot that froze meanwhile is found only once its silence has been counted anew.
TEST(SupervisorSilence, DoesNotKnowWhoIsSilentRightAfterAGapOfItsOwn) {
  SilenceBench bench;
  bench.fly();
  EXPECT_TRUE(bench.sut->knows_silent(bench.now));
  bench.freeze(2);
  bench.now += milliseconds(1200);
  bench.run_for(milliseconds(2900));
  EXPECT_FALSE(bench.sut->knows_silent(bench.now));
  EXPECT_TRUE(bench.sut->silent().empty());
  bench.run_for(milliseconds(300));
  EXPECT_TRUE(bench.sut->knows_silent(bench.now));
  EXPECT_EQ(bench.sut->silent(), std::vector{RobotId(2)});
}

TEST(SupervisorSilence, EndsNoProcessWhileMostOfThemAreSilent) {
  SilenceBench bench;
  bench.fly();
  bench.freeze(0);
  bench.freeze(1);
  bench.freeze(2);
  bench.run_for(seconds(30));
  EXPECT_TRUE(bench.logged("agent-silent")) << "they are named";
  EXPECT_TRUE(bench.signals.empty()) << "the machine or the launcher is the likely cause";
  bench.reporting.emplace_back(0);
  bench.run_for(seconds(1));
  EXPECT_TRUE(bench.is_killed(2) && bench.is_killed(3)) << "two of five";
}

TEST(SupervisorSilence, LeavesProcessesOfOtherHostsToTheWatchOfHosts) {
  SilenceBench bench;
  bench.fly_with_other_host(1, 3);
  bench.run_for(seconds(30));
  EXPECT_TRUE(bench.signals.empty());
}

TEST(SupervisorSilence, KillsAPlannerThatIsTheOnlyProcessHere) {
  for (const bool receives_others : {false, true}) {
    SilenceBench bench;
    bench.fly_with_other_host(4, receives_others ? 4 : 0);
    bench.planner_epoch = 0;
    bench.run_for(seconds(11));
    EXPECT_EQ(bench.is_killed(0), receives_others);
  }
}

TEST(SupervisorSilence, KillsARestartedAgentThatNeverReports) {
  SilenceBench bench;
  bench.options.launcher.respawn_agent_max = 2;
  bench.fly();
  bench.freeze(1);
  bench.run_for(seconds(11));
  ASSERT_EQ(bench.starts(2), 2);
  bench.run_for(seconds(28));
  EXPECT_EQ(bench.starts(2), 2);
  bench.run_for(seconds(5));
  EXPECT_EQ(bench.starts(2), 3);
  bench.run_for(seconds(60));
  EXPECT_EQ(bench.starts(2), 3) << "it ended three times in a row, and two are allowed";
  EXPECT_EQ(bench.sut->lost(), std::vector{RobotId(1)});
}

// Another host that is stopped itself does not report the end of its process.
TEST(SupervisorSilence, GoesOnWithoutAProcessOfAnotherHostAfterAMinute) {
  SilenceBench bench;
  bench.fly_with_other_host(1, 3);
  bench.run_for(seconds(59));
  EXPECT_TRUE(bench.sut->lost().empty());
  bench.run_for(seconds(2));
  EXPECT_EQ(bench.sut->lost(), std::vector{RobotId(3)});
  EXPECT_TRUE(bench.logged("agent-given-up"));

  bench.reporting.emplace_back(3);
  bench.run_for(seconds(1));
  EXPECT_TRUE(bench.sut->lost().empty());
}

TEST(SupervisorAbsence, LeavesOutAProcessThatHangsWhileItStarts) {
  SilenceBench bench(5);
  bench.options.launcher.quorum_share = 0.8;
  bench.options.launcher.quorum_timeout_s = 5.0;
  for (std::uint32_t i = 0; i < 4; ++i) bench.reporting.emplace_back(i);
  bench.run_for(seconds(8));
  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kRunning);
  EXPECT_TRUE(bench.logged("1 of 5 robots are not ready after 5 s: 4"));
  EXPECT_EQ(bench.sut->lost(), std::vector{RobotId(4)});
  EXPECT_EQ(bench.fallen, (Robots{{RobotId(4)}}));

  bench.reporting.clear();
  for (int i = 0; i < 4; ++i) {
    for (std::uint32_t robot = 0; robot < 4; ++robot) {
      bench.sut->on_status(RobotId(robot), {true, true, RobotMode::kArrived, true});
    }
    bench.run_for(seconds(1));
  }
  EXPECT_EQ(bench.sut->outcome(), Outcome::kCompleted) << "not waited for to the time limit";
}

TEST(SupervisorAbsence, EndsWhenTheAbsentReports) {
  SilenceBench bench(5);
  bench.options.launcher.quorum_share = 0.8;
  bench.options.launcher.quorum_timeout_s = 5.0;
  for (std::uint32_t i = 0; i < 4; ++i) bench.reporting.emplace_back(i);
  bench.run_for(seconds(8));
  ASSERT_EQ(bench.sut->lost(), std::vector{RobotId(4)});

  bench.reporting.emplace_back(4);
  bench.run_for(milliseconds(200));
  EXPECT_TRUE(bench.sut->lost().empty());
  EXPECT_TRUE(bench.logged("late-joiners: robots that were absent report: 4"));
  EXPECT_EQ(bench.risen, (Robots{{RobotId(4)}}));
}

TEST(SupervisorAbsence, AnAbsentRobotNeedNotConfirmAStop) {
  SilenceBench bench(5);
  bench.options.launcher.quorum_share = 0.8;
  bench.options.launcher.quorum_timeout_s = 5.0;
  for (std::uint32_t i = 0; i < 4; ++i) bench.reporting.emplace_back(i);
  bench.run_for(seconds(8));
  bench.reporting.clear();
  bench.sut->on_command(CommandKind::kStop, bench.now);
  for (std::uint32_t i = 0; i < 4; ++i) bench.sut->on_stop_confirmed(RobotId(i));
  EXPECT_TRUE(bench.sut->unstopped().empty());
}

TEST(SupervisorAbsence, ARobotThatReportedAndDiedIsNotReady) {
  SilenceBench bench(3);
  bench.options.launcher.quorum_timeout_s = 5.0;
  bench.options.launcher.respawn_agent_max = 0;
  bench.run_for(seconds(1));
  bench.report_all(RobotMode::kWaiting);
  bench.sut->on_exit(ProcessIndex(2), {.code = 0, .signal = 9}, bench.now);
  bench.run_for(seconds(2));
  EXPECT_TRUE(bench.commands.empty()) << "two of three are there, and all are needed";
  EXPECT_EQ(bench.sut->counts().ready, 2U);
  bench.run_for(seconds(5));
  EXPECT_TRUE(bench.logged("1 of 3 robots are not ready after 5 s: 1"));
  EXPECT_EQ(bench.sut->outcome(), Outcome::kQuorumTimeout);
}

TEST(SupervisorJoins, DoNotMoveTheTimeOutOfTheStart) {
  SilenceBench bench(4);
  bench.options.remote_processes = 1;
  bench.options.launcher.quorum_timeout_s = 10.0;
  for (int i = 0; i < 12; ++i) {  // a host that joins again and again
    bench.run_for(seconds(1));
    bench.sut->on_joined(ProcessIndex(4), 1, bench.now);
    bench.sut->on_exit(ProcessIndex(4), {}, bench.now);
  }
  EXPECT_EQ(bench.sut->outcome(), Outcome::kQuorumTimeout);
}

}  // namespace
}  // namespace swarm::launcher
