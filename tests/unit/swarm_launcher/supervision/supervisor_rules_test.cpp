// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The supervisor's rules, each over all small cases. Its clock is a number that the test sets.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_launcher/supervision/supervisor.hpp"

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;
using Stage = Supervisor::Stage;

SteadyTime at_s(double s) { return SteadyTime(from_seconds(1000.0 + s)); }

template <class T>
std::vector<T> all_of(const std::vector<Action>& actions) {
  std::vector<T> found;
  for (const Action& action : actions) {
    if (const auto* one = std::get_if<T>(&action)) found.push_back(*one);
  }
  return found;
}

/// Reports of all robots; they have a plan and receive their neighbours.
void report_all(Supervisor& sut, std::uint32_t robots, RobotMode mode, bool settled = false) {
  for (std::uint32_t i = 0; i < robots; ++i) {
    sut.on_status(RobotId(i), {true, true, mode, settled});
  }
}

SupervisorOptions options_of(std::uint32_t robots) {
  SupervisorOptions options;
  options.robots = robots;
  options.launcher.starts_per_s = 1000.0;
  options.launcher.starting_max = 1000;
  return options;
}

/// A mission that has been running for 0 s at at_s(1).
Supervisor running(const SupervisorOptions& options) {
  Supervisor sut(options, at_s(0));
  sut.step(at_s(0.9));
  report_all(sut, options.robots, RobotMode::kWaiting);
  sut.step(at_s(1));
  EXPECT_EQ(sut.stage(), Stage::kRunning);
  return sut;
}

/// Lets all processes end when they are signalled.
void end_all(Supervisor& sut, double from_s) {
  for (const auto& signal : all_of<SignalProcess>(sut.step(at_s(from_s)))) {
    sut.on_exit(signal.process, {}, at_s(from_s));
  }
  sut.step(at_s(from_s + 0.05));
}

TEST(SupervisorRules, DivideTheRobotsOverTheProcessesWithoutGapOrOverlap) {
  for (std::uint32_t robots = 1; robots <= 20; ++robots) {
    for (std::uint32_t per = 1; per <= 21; ++per) {
      SupervisorOptions options = options_of(robots);
      options.per_process = per;
      const Supervisor sut(options, at_s(0));
      EXPECT_EQ(sut.robots_of(kPlanner).second, 0U);
      std::uint32_t next = 0;
      for (std::uint32_t i = 1; i < sut.processes(); ++i) {
        const auto [first, count] = sut.robots_of(ProcessIndex(i));
        EXPECT_EQ(first.value(), next);
        EXPECT_TRUE(count >= 1 && count <= per);
        next += count;
      }
      EXPECT_EQ(next, robots) << robots << " by " << per;
    }
  }
}

TEST(SupervisorRules, StartTheMissionWithoutTheMissingIffTheQuorumIsThere) {
  for (std::uint32_t robots = 1; robots <= 5; ++robots) {
    for (std::uint32_t ready = 0; ready < robots; ++ready) {
      for (const double share : {0.01, 0.25, 0.5, 0.8, 1.0}) {
        SupervisorOptions options = options_of(robots);
        options.launcher.quorum_share = share;
        options.launcher.quorum_timeout_s = 20.0;
        Supervisor sut(options, at_s(0));
        sut.step(at_s(1));  // the last start
        report_all(sut, ready, RobotMode::kWaiting);
        EXPECT_TRUE(sut.step(at_s(20.9)).empty()) << "all are waited for until the timeout";

        const auto log = all_of<LogEvent>(sut.step(at_s(21)));

        ASSERT_FALSE(log.empty());
        EXPECT_TRUE(log[0].warning);
        EXPECT_EQ(log[0].code, "quorum");
        const bool enough = ready >= share * robots;
        EXPECT_EQ(sut.stage(), enough ? Stage::kRunning : Stage::kEnding);
        EXPECT_EQ(sut.outcome(), enough ? Outcome::kNone : Outcome::kQuorumTimeout);
      }
    }
  }
}

TEST(SupervisorRules, NameTheMissingInTheWarning) {
  Supervisor sut(options_of(9), at_s(0));
  sut.step(at_s(1));
  for (const std::uint32_t i : {0U, 2U, 6U}) {
    sut.on_status(RobotId(i), {true, true, RobotMode::kWaiting});
  }
  sut.on_status(RobotId(8), {true, false, RobotMode::kWaiting});
  const auto log = all_of<LogEvent>(sut.step(at_s(31)));
  ASSERT_EQ(log.size(), 1U);
  EXPECT_EQ(log[0].text, "6 of 9 robots are not ready after 30 s: 1, 3-5, 7-8");
}

TEST(SupervisorRules, ApplyACommandAsEveryOtherProgramDoes) {
  constexpr CommandKind kKinds[] = {CommandKind::kStart, CommandKind::kPause, CommandKind::kResume,
                                    CommandKind::kStop};
  for (int sequence = 0; sequence < 4 * 4 * 4 * 4; ++sequence) {
    Supervisor sut(options_of(1), at_s(0));
    MissionPhase expected = MissionPhase::kReady;
    for (int i = 0, code = sequence; i < 4; ++i, code /= 4) {
      sut.on_command(kKinds[code % 4], at_s(0));
      expected = phase_after(expected, kKinds[code % 4]);
      const auto sent = all_of<SendCommand>(sut.step(at_s(0)));
      ASSERT_EQ(sut.phase(), expected) << "sequence " << sequence << ", command " << i;
      ASSERT_EQ(sent.size(), 1U) << "every command is sent, whether it applies or not";
      EXPECT_EQ(sent[0].kind, kKinds[code % 4]);
      if (sut.outcome() != Outcome::kNone || expected == MissionPhase::kStopped) break;
    }
  }
}

TEST(SupervisorRules, RestartAPlannerUnlessItReportsThatItCannotPlan) {
  for (int code = 0; code <= 4; ++code) {
    Supervisor sut = running(options_of(2));
    sut.on_exit(kPlanner, {.code = code, .signal = 0}, at_s(2));
    sut.step(at_s(2.2));
    EXPECT_TRUE(all_of<StartProcess>(sut.step(at_s(2.29))).empty()) << "not at once";
    const auto starts = all_of<StartProcess>(sut.step(at_s(2.3)));
    const bool hopeless = code == 1 || code == 3;  // criteria not met, usage
    EXPECT_EQ(starts.size(), hopeless ? 0U : 1U) << "code " << code;
    EXPECT_EQ(sut.outcome(), Outcome::kNone) << "robots in flight hold without it";
  }
  Supervisor sut = running(options_of(2));
  sut.on_exit(kPlanner, {.code = 1, .signal = 11}, at_s(2));
  EXPECT_EQ(all_of<StartProcess>(sut.step(at_s(3))).size(), 1U) << "the code of a crash is none";
}

TEST(SupervisorRules, ReportAProcessThatIsSilentAndItsReturnOnce) {
  SupervisorOptions options = options_of(4);
  options.per_process = 2;
  Supervisor sut = running(options);
  constexpr RobotReport kMoves{true, true, RobotMode::kMoving, false};
  std::vector<std::string> events;
  auto run_until = [&, t = 1.0](double end, bool second_reports) mutable {
    for (; t < end; t += 0.5) {
      sut.on_status(RobotId(0), kMoves);
      if (second_reports) sut.on_status(RobotId(3), kMoves);
      for (const LogEvent& event : all_of<LogEvent>(sut.step(at_s(t)))) {
        if (event.code.starts_with("agent-")) events.push_back(event.code + ": " + event.text);
      }
    }
  };
  run_until(10, true);
  EXPECT_TRUE(events.empty());
  run_until(20, false);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0], "agent-silent: agent process 2 (robots 2 to 3) has sent no status for 3 s");
  run_until(30, true);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[1], "agent-back: agent process 2 (robots 2 to 3) sends its status again");
}

TEST(SupervisorRules, AllowEachProcessItsOwnRestartsAndNoMore) {
  for (std::uint32_t allowed = 0; allowed <= 3; ++allowed) {
    SupervisorOptions options = options_of(3);
    options.launcher.respawn_agent_max = allowed;
    Supervisor sut = running(options);
    double t = 2.0;
    for (std::uint32_t death = 1; death <= allowed + 1; ++death, t += 3.0) {
      for (const std::uint32_t process : {1U, 3U}) {
        sut.on_exit(ProcessIndex(process), {.code = 0, .signal = 9}, at_s(t));
      }
      const auto starts = all_of<StartProcess>(sut.step(at_s(t + 2.5)));
      EXPECT_EQ(starts.size(), death <= allowed ? 2U : 0U);
      EXPECT_EQ(sut.lost().size(), death <= allowed ? 0U : 2U);
    }
    EXPECT_EQ(sut.lost(), (std::vector<RobotId>{RobotId(0), RobotId(2)}));
    EXPECT_EQ(sut.stage(), Stage::kRunning) << "robot 1 is left";
    sut.on_exit(ProcessIndex(2), {}, at_s(t));
    for (std::uint32_t i = 0; i < allowed; ++i, t += 3.0) {
      sut.step(at_s(t + 2.5));
      sut.on_exit(ProcessIndex(2), {}, at_s(t + 2.6));
    }
    sut.step(at_s(t + 2.7));
    EXPECT_EQ(sut.outcome(), Outcome::kAllLost);
  }
}

TEST(SupervisorRules, EndTheMissionTwoSecondsAfterTheLastRobotSettled) {
  Supervisor sut = running(options_of(2));
  report_all(sut, 2, RobotMode::kArrived, true);
  sut.step(at_s(10));
  sut.on_status(RobotId(1), {true, true, RobotMode::kMoving});  // pushed out again
  sut.step(at_s(11.9));
  report_all(sut, 2, RobotMode::kArrived, true);
  sut.step(at_s(12));
  sut.step(at_s(13.99));
  EXPECT_EQ(sut.outcome(), Outcome::kNone) << "the time counts from the second arrival";
  sut.step(at_s(14));
  EXPECT_EQ(sut.outcome(), Outcome::kCompleted);
}

TEST(SupervisorRules, EndTheMissionTenSecondsAfterArrivalWhereNoRobotComesToRest) {
  Supervisor sut = running(options_of(2));
  report_all(sut, 2, RobotMode::kArrived, false);
  sut.step(at_s(10));
  sut.step(at_s(20));
  EXPECT_EQ(sut.outcome(), Outcome::kNone);
  sut.step(at_s(20.05));
  EXPECT_EQ(sut.outcome(), Outcome::kCompleted);
}

TEST(SupervisorRules, CountMissionTimeFromTheStartThroughPauses) {
  SupervisorOptions options = options_of(1);
  options.launcher.time_limit_s = 5.0;
  Supervisor before(options, at_s(0));
  EXPECT_EQ(before.mission_time(at_s(100)).count(), 0.0);

  Supervisor sut = running(options);
  sut.on_command(CommandKind::kPause, at_s(2));
  sut.step(at_s(2));
  EXPECT_NEAR(sut.mission_time(at_s(4)).count(), 3.0, 1e-9);
  sut.step(at_s(6));
  EXPECT_EQ(sut.outcome(), Outcome::kNone) << "exactly at the limit";
  sut.step(at_s(6.01));
  EXPECT_EQ(sut.outcome(), Outcome::kTimeLimit);
}

TEST(SupervisorRules, SendAtMostTwoStopsInAStepThatIsLate) {
  Supervisor sut = running(options_of(1));
  sut.on_command(CommandKind::kStop, at_s(2));
  EXPECT_EQ(all_of<SendCommand>(sut.step(at_s(2))).size(), 1U);
  EXPECT_EQ(all_of<SendCommand>(sut.step(at_s(2.09))).size(), 0U);
  EXPECT_EQ(all_of<SendCommand>(sut.step(at_s(2.1))).size(), 1U);
  EXPECT_EQ(all_of<SendCommand>(sut.step(at_s(4))).size(), 2U);
}

TEST(SupervisorRules, KeepTheFirstReasonForTheEnd) {
  Supervisor sut = running(options_of(1));
  report_all(sut, 1, RobotMode::kArrived, true);
  sut.step(at_s(10));
  sut.step(at_s(12));
  ASSERT_EQ(sut.outcome(), Outcome::kCompleted);
  sut.on_command(CommandKind::kStop, at_s(12));
  sut.on_exit(kPlanner, {.code = 1, .signal = 0}, at_s(12));
  sut.on_interrupt();
  end_all(sut, 12.1);
  EXPECT_EQ(sut.outcome(), Outcome::kCompleted);
  EXPECT_EQ(sut.stage(), Stage::kDone);
}

TEST(SupervisorRules, ClimbToTheSignalThatIsDueWhenStepsAreLate) {
  SupervisorOptions options = options_of(1);
  options.signal_grace = milliseconds(1000);
  const struct {
    double late_s;
    EndSignal signal;
  } cases[] = {{0.99, EndSignal::kInterrupt},
               {1.0, EndSignal::kTerminate},
               {2.0, EndSignal::kKill},
               {500.0, EndSignal::kKill}};
  for (const auto& c : cases) {
    Supervisor sut(options, at_s(0));
    sut.step(at_s(0.9));
    sut.on_exit(kPlanner, {.code = 1, .signal = 0},
                at_s(2));  // before the start: begins the ending
    const auto signals = all_of<SignalProcess>(sut.step(at_s(2.0 + c.late_s)));
    ASSERT_EQ(signals.size(), 1U) << "the planner has ended";
    EXPECT_EQ(signals[0].process, ProcessIndex(1));
    EXPECT_EQ(signals[0].signal, c.signal) << c.late_s;
    EXPECT_TRUE(sut.step(at_s(2.0 + c.late_s)).empty()) << "each signal once";
  }
}

}  // namespace
}  // namespace swarm::launcher
