// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Processes that end, that cannot be started, and robots that are not received.
#include <string>
#include <string_view>

#include "swarm_core/app/file_watch.hpp"
#include "swarm_core/mission/scene_bodies.hpp"
#include "tests/unit/swarm_launcher/flight/flight_bench.hpp"

namespace swarm::launcher {
namespace {

constexpr ProcessExit kCrash{.code = 0, .signal = 11};

class FlightLoopFailure : public FlightBench {
 protected:
  bool has_body_of(std::uint32_t robot) const { return has_body(scene->scene(), RobotId(robot)); }
  bool runs(std::uint32_t robot) const {
    return std::any_of(spawner.children.begin(), spawner.children.end(), [&](const auto& child) {
      return child.runs && !child.is_planner() && child.first_robot() == robot;
    });
  }
};

TEST_F(FlightLoopFailure, RestartsAnAgentThatExitsDuringTheStart) {
  options.mission.launcher.respawn_agent_max = 1;
  robots[1].silent = true;
  run_for(seconds(1));
  spawner.end(spawner.agent(1), {.code = 2, .signal = 0});
  robots[1].silent = false;

  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  EXPECT_TRUE(runs(1));
  EXPECT_EQ(spawner.children.size(), 2U + kRobots);
  EXPECT_TRUE(is_logged("respawn"));
}

TEST_F(FlightLoopFailure, GivesUpWhenAnAgentExitsDuringTheStartForGood) {
  options.mission.launcher.respawn_agent_max = 0;
  robots[1].silent = true;
  run_for(seconds(1));
  spawner.end(spawner.agent(1), {.code = 2, .signal = 0});

  ASSERT_TRUE(run_to_the_end());
  EXPECT_EQ(outcome(), Outcome::kQuorumTimeout);
  EXPECT_TRUE(is_logged("agent-exit"));
  EXPECT_EQ(sent(CommandKind::kStart), 0U);
}

TEST_F(FlightLoopFailure, MakesAnAgentThatDiesAnObstacleUntilItsSuccessorReports) {
  options.mission.launcher.respawn_agent_max = 1;
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  spawner.end(spawner.agent(1), kCrash);
  run_for(milliseconds(100));
  EXPECT_TRUE(has_body_of(1));
  EXPECT_FALSE(runs(1));

  run_for(seconds(1));
  EXPECT_TRUE(runs(1));
  EXPECT_FALSE(has_body_of(1));
  EXPECT_TRUE(is_logged("body-added"));
  EXPECT_TRUE(is_logged("body-cleared"));
  arrive();
  ASSERT_TRUE(run_to_the_end());
  EXPECT_EQ(outcome(), Outcome::kCompleted);
}

TEST_F(FlightLoopFailure, CompletesWithoutAnAgentWhoseRestartsAreSpent) {
  options.mission.launcher.respawn_agent_max = 1;
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  for (int i = 0; i < 2; ++i) {
    spawner.end(spawner.agent(1), kCrash);
    run_for(seconds(2));
  }

  EXPECT_FALSE(runs(1));
  EXPECT_TRUE(has_body_of(1));
  EXPECT_EQ(loop->supervisor().lost(), std::vector{RobotId(1)});
  arrive();
  ASSERT_TRUE(run_to_the_end());
  EXPECT_EQ(outcome(), Outcome::kCompleted);
}

TEST_F(FlightLoopFailure, ReportsAFallenRobotWhosePositionIsUnknown) {
  robots[1].silent = true;
  run_for(seconds(1));
  spawner.end(spawner.agent(1), kCrash);
  run_for(seconds(1));
  EXPECT_FALSE(has_body_of(1));
  EXPECT_TRUE(is_logged("body-unknown"));
}

TEST_F(FlightLoopFailure, RestartsThePlanner) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  spawner.end(spawner.planner(), kCrash);
  run_for(seconds(1));

  EXPECT_TRUE(spawner.planner().runs);
  EXPECT_TRUE(is_logged("planner-exit"));
  arrive();
  ASSERT_TRUE(run_to_the_end());
  EXPECT_EQ(outcome(), Outcome::kCompleted);
}

TEST_F(FlightLoopFailure, EndsBeforeTheStartWhenThePlannerCannotPlan) {
  run_for(milliseconds(100));
  ASSERT_EQ(loop->supervisor().phase(), MissionPhase::kReady);
  spawner.end(spawner.planner(),
              {.code = static_cast<int>(ExitCode::kCriteriaNotMet), .signal = 0});
  ASSERT_TRUE(run_to_the_end());
  EXPECT_EQ(outcome(), Outcome::kPlannerFailed);
}

TEST_F(FlightLoopFailure, StartsWithoutARobotWhoseStatusNeverComesIfTheOthersAreEnough) {
  options.mission.launcher.quorum_share = 0.5;
  options.mission.launcher.quorum_timeout_s = 10.0;
  robots[2].silent = true;
  run_for(seconds(9));
  EXPECT_EQ(sent(CommandKind::kStart), 0U);

  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  EXPECT_TRUE(is_logged("quorum"));
  EXPECT_NE(display.printed.find("1 of 3 robots are not ready after 10 s: 2"), std::string::npos);
}

TEST_F(FlightLoopFailure, EndsWhenARobotWhoseStatusNeverComesIsNeeded) {
  options.mission.launcher.quorum_timeout_s = 10.0;
  robots[2].silent = true;
  ASSERT_TRUE(run_to_the_end());
  EXPECT_EQ(outcome(), Outcome::kQuorumTimeout);
}

TEST_F(FlightLoopFailure, FailsAndKillsItsProcessesWhenOneCannotBeStarted) {
  spawner.starts_left = 2;
  ASSERT_TRUE(run_until([&] { return !error.empty(); }));
  EXPECT_EQ(error, "no process left");
  EXPECT_EQ(spawner.count_running(), 2U);

  loop.reset();
  EXPECT_EQ(spawner.count_running(), 0U);
  EXPECT_EQ(spawner.children.front().signals, std::vector{EndSignal::kKill});
}

// The kernel may have killed the planner for lack of memory, which a new process lacks as well.
TEST_F(FlightLoopFailure, TriesAgainWhenThePlannerCannotBeStartedInFlight) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  spawner.starts_left = spawner.children.size();
  spawner.end(spawner.planner(), kCrash);
  run_for(seconds(2));
  EXPECT_TRUE(is_logged("start-failed"));
  EXPECT_TRUE(error.empty()) << error;
  EXPECT_EQ(spawner.count_running(), kRobots);

  spawner.starts_left = 100;
  run_for(seconds(10));

  EXPECT_EQ(spawner.count_running(), kRobots + 1);
  arrive();
  ASSERT_TRUE(run_to_the_end());
  EXPECT_EQ(outcome(), Outcome::kCompleted);
}

// A process that is killed on a full disk takes with it what it had not written.
TEST_F(FlightLoopFailure, CountsTheFilesOfAProcessThatIsKilledOnAFullDiskAsLost) {
  begin();
  const auto report = [this](std::uint32_t source, std::string_view code) {
    log->forward({.source = source, .code = std::string(code)});
  };
  report(link::kPlannerSource, shell::kDiskFails);
  report(7, shell::kDiskFails);
  report(8, shell::kDiskFails);
  report(8, shell::kDiskWorks);

  log->on_killed(8, 2);
  EXPECT_TRUE(log->losses().empty());
  log->on_killed(6, 2);
  ASSERT_EQ(log->losses().size(), 1U);
  EXPECT_EQ(log->losses()[0], "robot-7: its process was killed while it could not write its files");
  log->on_killed(link::kPlannerSource, 1);
  ASSERT_EQ(log->losses().size(), 2U);
  EXPECT_EQ(log->losses()[1], "planner: its process was killed while it could not write its files");
  log->on_killed(link::kPlannerSource, 1);
  EXPECT_EQ(log->losses().size(), 2U);
}

TEST_F(FlightLoopFailure, LogsAHelperThatEndsAndFliesOn) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  spawner.end_other(FakeHelpers::kPid, {});
  run_for(seconds(1));
  EXPECT_TRUE(is_logged("monitor-exit"));
  EXPECT_EQ(loop->children().size(), 1U + kRobots);
}

}  // namespace
}  // namespace swarm::launcher
