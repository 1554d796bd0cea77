// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A mission from its first process to its last, and how a user ends it early.
#include "tests/unit/swarm_launcher/flight/flight_bench.hpp"

namespace swarm::launcher {
namespace {

class FlightLoopMission : public FlightBench {};

TEST_F(FlightLoopMission, FliesFromTheFirstProcessToTheLast) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  ASSERT_EQ(spawner.children.size(), 1U + kRobots);
  EXPECT_TRUE(spawner.children.front().is_planner());
  EXPECT_EQ(loop->children().size(), 1U + kRobots);
  run_for(seconds(5));
  EXPECT_EQ(sent(CommandKind::kStart), 1U);
  EXPECT_EQ(robots.front().mode, RobotMode::kMoving);

  arrive();
  ASSERT_TRUE(run_to_the_end());

  EXPECT_EQ(outcome(), Outcome::kCompleted);
  EXPECT_TRUE(loop->children().empty());
  for (const FakeChild& child : spawner.children) {
    EXPECT_EQ(child.signals, std::vector{EndSignal::kInterrupt});
  }
  EXPECT_TRUE(is_logged("command"));
  EXPECT_EQ(display.headlines.front(), "starting 4 processes");
  EXPECT_EQ(display.headlines.back(), "mission running");
}

TEST_F(FlightLoopMission, MeasuresChildrenAndDiscovery) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  arrive();
  ASSERT_TRUE(run_to_the_end());

  const Measurements measured = loop->measurements();
  EXPECT_EQ(measured.outcome, Outcome::kCompleted);
  EXPECT_DOUBLE_EQ(measured.cpu_s, 0.5 * (1 + kRobots));
  EXPECT_DOUBLE_EQ(measured.max_rss_mb, 12.0);
  EXPECT_GE(measured.discovery_s, 0.0);
  EXPECT_GE(measured.neighbour_discovery_s, 0.0);
  EXPECT_EQ(measured.refused_by_launcher, 0U);
}

TEST_F(FlightLoopMission, StopsAtTheTimeLimit) {
  options.mission.launcher.time_limit_s = 20.0;
  ASSERT_TRUE(run_to_the_end());
  EXPECT_EQ(outcome(), Outcome::kTimeLimit);
}

TEST_F(FlightLoopMission, RepublishesStatusesAndEventsForMonitors) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  others.events->write({.source = 1, .code = "late-tick", .text = "200 ms"});
  run_for(seconds(1));

  std::vector<link::StatusMessage> statuses;
  others.relayed_statuses->take(statuses);
  EXPECT_GE(statuses.size(), kRobots);
  std::vector<link::EventMessage> events;
  others.relayed_events->take(events);
  EXPECT_TRUE(std::any_of(events.begin(), events.end(),
                          [](const auto& event) { return event.code == "late-tick"; }));
  EXPECT_TRUE(is_logged("late-tick"));
}

TEST_F(FlightLoopMission, IgnoresStatusesThatTheGateRefuses) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  others.statuses->write({.first_robot_id = kRobots, .plan_version = 1});
  run_for(seconds(1));
  EXPECT_EQ(loop->measurements().refused_by_launcher, 1U);
}

TEST_F(FlightLoopMission, ShowsFourTimesASecondAtMost) {
  run_for(seconds(10));
  EXPECT_GE(display.shown, 35);
  EXPECT_LE(display.shown, 41);
}

TEST_F(FlightLoopMission, StampsTwoCommandsOfOneStepDifferently) {
  options.mission.script = {{1.0, CommandKind::kPause}, {1.0, CommandKind::kResume}};
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  run_for(seconds(2));

  ASSERT_EQ(commands.size(), 3U);
  EXPECT_EQ(commands[1].kind, CommandKind::kPause);
  EXPECT_EQ(commands[2].kind, CommandKind::kResume);
  EXPECT_LT(commands[1].command_id, commands[2].command_id);
}

TEST_F(FlightLoopMission, EndsAllProcessesAfterAnInterrupt) {
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  loop->interrupt();
  ASSERT_TRUE(run_to_the_end());
  EXPECT_EQ(outcome(), Outcome::kInterrupted);
  EXPECT_EQ(spawner.count_running(), 0U);
}

TEST_F(FlightLoopMission, SignalsMoreStronglyWhenAProcessDoesNotEnd) {
  spawner.obedient = false;
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  loop->interrupt();
  ASSERT_TRUE(run_to_the_end());
  EXPECT_EQ(spawner.children.front().signals,
            (std::vector{EndSignal::kInterrupt, EndSignal::kTerminate, EndSignal::kKill}));
}

TEST_F(FlightLoopMission, KillsAllProcessesAfterASecondInterrupt) {
  spawner.obedient = false;
  ASSERT_TRUE(run_to_phase(MissionPhase::kRunning));
  loop->interrupt();
  run_for(milliseconds(100));
  loop->interrupt();
  ASSERT_TRUE(run_until([&] { return loop->is_done(); }, milliseconds(100)));
  EXPECT_EQ(spawner.children.front().signals,
            (std::vector{EndSignal::kInterrupt, EndSignal::kKill}));
}

TEST_F(FlightLoopMission, EndsAnInterruptedStartWithoutStartingMore) {
  options.mission.launcher.starts_per_s = 1.0;
  run_for(milliseconds(100));
  const std::size_t started = spawner.children.size();
  ASSERT_LT(started, 1U + kRobots);
  loop->interrupt();
  ASSERT_TRUE(run_to_the_end());
  EXPECT_EQ(spawner.children.size(), started);
}

}  // namespace
}  // namespace swarm::launcher
