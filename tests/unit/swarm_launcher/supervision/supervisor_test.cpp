// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/supervision/supervisor.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <gtest/gtest.h>

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Drives a supervisor with a simulated clock and plays the part of its processes.
struct Bench {
  SteadyTime now{seconds(100)};
  SupervisorOptions options;
  std::optional<Supervisor> sut;
  std::vector<std::uint32_t> started;
  std::vector<CommandKind> commands;
  std::vector<SceneChange> changes;
  std::vector<std::pair<std::uint32_t, EndSignal>> signals;
  std::vector<std::vector<RobotId>> fallen, risen;  // one entry a step
  std::vector<std::string> log;
  bool obedient = true;  // children end when they are asked to

  explicit Bench(std::uint32_t robots, std::uint32_t per_process = 1) {
    options.robots = robots;
    options.per_process = per_process;
    options.launcher.starts_per_s = 10.0;
  }

  void run_for(Duration d) {
    if (!sut) sut.emplace(options, now);
    for (const SteadyTime until = now + d; now < until; now += milliseconds(50)) {
      for (const Action& action : sut->step(now)) take(action);
    }
  }

  void take(const Action& action) {
    if (const auto* start = std::get_if<StartProcess>(&action))
      started.push_back(start->process.value());
    if (const auto* command = std::get_if<SendCommand>(&action)) commands.push_back(command->kind);
    if (const auto* scene = std::get_if<ChangeScene>(&action)) {
      changes.push_back(scene->change);
      if (std::holds_alternative<GoTo>(scene->change)) sut->on_new_goal(77);
    }
    if (const auto* bodies = std::get_if<AddBodies>(&action)) fallen.push_back(bodies->robots);
    if (const auto* bodies = std::get_if<ClearBodies>(&action)) risen.push_back(bodies->robots);
    if (const auto* event = std::get_if<LogEvent>(&action))
      log.push_back(event->code + ": " + event->text);
    if (const auto* signal = std::get_if<SignalProcess>(&action)) {
      signals.emplace_back(signal->process.value(), signal->signal);
      if (obedient) sut->on_exit(signal->process, {}, now);
    }
  }

  void report_all(RobotMode mode, bool settled = false, std::uint64_t scene_version = 0) {
    for (std::uint32_t i = 0; i < options.robots; ++i) {
      sut->on_status(RobotId(i), {true, true, mode, settled, scene_version});
    }
  }

  bool logged(const std::string& fragment) const {
    return std::any_of(log.begin(), log.end(),
                       [&](const std::string& l) { return l.find(fragment) != std::string::npos; });
  }
};

TEST(Supervisor, StartsThePlannerThenAgentsInWaves) {
  Bench bench(30);
  bench.options.launcher.starting_max = 30;

  bench.run_for(milliseconds(1000));

  EXPECT_EQ(bench.started.front(), 0U);
  EXPECT_GE(bench.started.size(), 10U);
  EXPECT_LE(bench.started.size(), 12U);
}

TEST(Supervisor, WaitsForTheStartedBeforeItStartsMore) {
  Bench bench(30);
  bench.options.launcher.starting_max = 4;

  bench.run_for(milliseconds(2000));
  EXPECT_EQ(bench.started.size(), 1U + 4U);

  bench.sut->on_status(RobotId(1), {});
  bench.run_for(milliseconds(100));
  EXPECT_EQ(bench.started.size(), 1U + 5U);
}

TEST(Supervisor, DoesNotWaitLongForAProcessThatHangs) {
  Bench bench(8);
  bench.options.launcher.starting_max = 4;

  bench.run_for(seconds(8));

  EXPECT_EQ(bench.started.size(), 1U + 8U);
}

TEST(Supervisor, StartsTheMissionWhenEveryRobotIsReady) {
  Bench bench(5);
  bench.run_for(seconds(1));
  EXPECT_TRUE(bench.commands.empty());

  bench.report_all(RobotMode::kWaiting);
  bench.run_for(milliseconds(100));

  ASSERT_EQ(bench.commands.size(), 1U);
  EXPECT_EQ(bench.commands[0], CommandKind::kStart);
  EXPECT_GE(bench.sut->discovery_s(), 0.0);
}

TEST(Supervisor, LeavesRemoteRobotsToOtherHosts) {
  Bench bench(4);
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
  Bench bench(4);
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
  Bench bench(3);
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

TEST(Supervisor, NamesWhoIsMissingAndGivesUp) {
  Bench bench(5);
  bench.run_for(seconds(1));
  for (const std::uint32_t i : {0U, 2U})
    bench.sut->on_status(RobotId(i), {true, true, RobotMode::kWaiting, false});

  bench.run_for(seconds(35));

  EXPECT_TRUE(bench.logged("1, 3-4"));
  EXPECT_EQ(bench.sut->outcome(), Outcome::kQuorumTimeout);
  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kDone);
  EXPECT_LT(bench.sut->discovery_s(), 0.0);
}

TEST(Supervisor, GoesOnWithAQuorumAfterTheTimeOut) {
  Bench bench(5);
  bench.options.launcher.quorum_share = 0.8;
  bench.run_for(seconds(1));
  for (std::uint32_t i = 0; i < 4; ++i)
    bench.sut->on_status(RobotId(i), {true, true, RobotMode::kWaiting, false});

  bench.run_for(seconds(31));

  EXPECT_TRUE(bench.logged("not ready"));
  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kRunning);
}

struct Running : Bench {
  explicit Running(std::uint32_t robots) : Bench(robots) {}
  void start() {
    run_for(seconds(2));
    report_all(RobotMode::kWaiting);
    run_for(milliseconds(100));
    ASSERT_EQ(sut->stage(), Supervisor::Stage::kRunning);
  }
};

TEST(Supervisor, EndsWhenAllHaveSettled) {
  Running bench(5);
  bench.start();

  bench.report_all(RobotMode::kArrived, true);
  bench.run_for(seconds(1));
  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kRunning) << "one may be pushed out again";
  bench.run_for(seconds(2));

  EXPECT_EQ(bench.sut->outcome(), Outcome::kCompleted);
  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kDone);
}

TEST(Supervisor, CountsAKilledAgentAsLostAndFliesOn) {
  Running bench(5);
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

RobotReport report_of(SteadyTime sent_at) {
  return {.has_plan = true,
          .receives_neighbours = true,
          .mode = RobotMode::kMoving,
          .sent_at = sent_at};
}

using Robots = std::vector<std::vector<RobotId>>;

TEST(Supervisor, CountsARobotThatStoppedItselfAsLost) {
  Running bench(3);
  bench.start();

  bench.report_all(RobotMode::kArrived, true);
  bench.sut->on_status(RobotId(1), {true, true, RobotMode::kStopped});
  bench.run_for(seconds(4));

  EXPECT_EQ(bench.sut->outcome(), Outcome::kCompleted);
  EXPECT_EQ(bench.sut->counts().arrived, 2U);
  EXPECT_EQ(bench.sut->lost(), std::vector<RobotId>{RobotId(1)});
}

TEST(SupervisorBodies, OfRobotsThatDieTogetherAreAddedAtOnce) {
  Running bench(5);
  bench.start();

  for (const std::uint32_t process : {4U, 2U}) {
    bench.sut->on_exit(ProcessIndex(process), {.code = 0, .signal = 9}, bench.now);
  }
  bench.run_for(seconds(2));  // less than after which the others, too, would be silent

  EXPECT_EQ(bench.fallen, (Robots{{RobotId(3), RobotId(1)}}));
  EXPECT_TRUE(bench.risen.empty());
}

TEST(SupervisorBodies, OfAProcessAreThoseOfAllItsRobots) {
  Bench bench(6, 3);
  bench.run_for(seconds(1));
  bench.report_all(RobotMode::kWaiting);
  bench.run_for(milliseconds(100));

  bench.sut->on_exit(ProcessIndex(2), {.code = 0, .signal = 9}, bench.now);
  bench.run_for(milliseconds(100));

  EXPECT_EQ(bench.fallen, (Robots{{RobotId(3), RobotId(4), RobotId(5)}}));
}

TEST(SupervisorBodies, StayUntilTheRespawnedRobotReports) {
  Running bench(3);
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
  Running bench(3);
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
  Running bench(3);
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
  Running bench(3);
  bench.start();
  for (int i = 0; i < 40; ++i) {  // 4 s, in which robot 1 reports nothing
    bench.sut->on_status(RobotId(0), report_of(bench.now));
    bench.sut->on_status(RobotId(2), report_of(bench.now));
    bench.run_for(milliseconds(100));
  }
  EXPECT_EQ(bench.fallen, (Robots{{RobotId(1)}})) << "once";
  EXPECT_EQ(bench.sut->silent(), std::vector{RobotId(1)});
  EXPECT_TRUE(bench.sut->lost().empty()) << "its process is alive";

  bench.sut->on_status(RobotId(1), report_of(bench.now));
  bench.run_for(milliseconds(100));

  EXPECT_EQ(bench.risen, (Robots{{RobotId(1)}}));
  EXPECT_TRUE(bench.sut->silent().empty());
}

TEST(SupervisorBodies, AreNoneOfProcessesThatEndWithTheMission) {
  Running bench(3);
  bench.start();

  bench.sut->on_interrupt();
  bench.run_for(seconds(1));

  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kDone);
  EXPECT_TRUE(bench.fallen.empty());
}

TEST(Supervisor, RestartsAPlannerThatCrashedButNotOneThatCannotPlan) {
  Running crashed(3);
  crashed.start();
  crashed.sut->on_exit(kPlanner, {.code = 0, .signal = 9}, crashed.now);
  crashed.run_for(seconds(1));
  EXPECT_EQ(std::count(crashed.started.begin(), crashed.started.end(), 0U), 2);
  EXPECT_EQ(crashed.sut->stage(), Supervisor::Stage::kRunning);

  Bench infeasible(3);
  infeasible.run_for(milliseconds(200));
  infeasible.sut->on_exit(kPlanner, {.code = 1, .signal = 0}, infeasible.now);
  infeasible.run_for(seconds(1));
  EXPECT_EQ(infeasible.sut->outcome(), Outcome::kPlannerFailed);
}

// Robots without a planner hold: that is no reason to end their processes.
TEST(Supervisor, RestartsAPlannerThatKeepsCrashingInFlightEverMoreSlowly) {
  Running bench(3);
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
  Running bench(3);
  bench.options.launcher.time_limit_s = 1e6;
  bench.start();
  const auto starts = [&] { return std::count(bench.started.begin(), bench.started.end(), 0U); };
  for (int deaths = 1; deaths <= 20; ++deaths) {
    bench.run_for(seconds(30));
    bench.sut->on_exit(kPlanner, {.code = 0, .signal = 11}, bench.now);
    bench.run_for(milliseconds(400));
    ASSERT_EQ(starts(), 1 + deaths);
  }
}

TEST(Supervisor, EndsBeforeTheStartWhenThePlannerKeepsCrashing) {
  Bench bench(3);
  bench.run_for(milliseconds(200));
  for (int deaths = 1; deaths <= 4; ++deaths) {
    bench.sut->on_exit(kPlanner, {.code = 0, .signal = 11}, bench.now);
    bench.run_for(seconds(3));
  }
  EXPECT_EQ(bench.sut->outcome(), Outcome::kPlannerFailed);
}

TEST(Supervisor, RepeatsAStopAndNamesWhoHasNotConfirmed) {
  Running bench(4);
  bench.start();
  for (const std::uint32_t i : {0U, 1U, 3U})
    bench.sut->on_status(RobotId(i), {true, true, RobotMode::kStopped, false});

  bench.sut->on_command(CommandKind::kStop, bench.now);
  bench.run_for(seconds(6));

  EXPECT_EQ(std::count(bench.commands.begin(), bench.commands.end(), CommandKind::kStop), 15);
  EXPECT_TRUE(bench.logged("not confirmed by 2"));
  EXPECT_EQ(bench.sut->outcome(), Outcome::kStopped);
}

TEST(Supervisor, ClimbsTheLadderOfSignals) {
  Running bench(2);
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
  Bench bench(100);
  bench.run_for(milliseconds(500));
  const std::size_t started = bench.started.size();

  bench.sut->on_interrupt();
  bench.run_for(seconds(1));

  EXPECT_EQ(bench.started.size(), started);
  EXPECT_EQ(bench.sut->stage(), Supervisor::Stage::kDone);
}

TEST(Supervisor, KillsAtTheSecondInterrupt) {
  Running bench(2);
  bench.start();
  bench.obedient = false;

  bench.sut->on_interrupt();
  bench.run_for(milliseconds(100));
  bench.sut->on_interrupt();
  bench.run_for(milliseconds(100));

  EXPECT_EQ(bench.signals.back().second, EndSignal::kKill);
}

TEST(Supervisor, PlaysTheScript) {
  Running bench(2);
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
  Running bench(2);
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
  Bench bench(10, 4);
  bench.run_for(seconds(1));

  EXPECT_EQ(bench.sut->processes(), 4U);
  EXPECT_EQ(bench.sut->robots_of(ProcessIndex(3)), std::pair(RobotId(8), 2U));
}

TEST(Supervisor, EndsAtTheTimeLimit) {
  Running bench(2);
  bench.options.launcher.time_limit_s = 5.0;
  bench.start();

  bench.run_for(seconds(6));

  EXPECT_EQ(bench.sut->outcome(), Outcome::kTimeLimit);
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
