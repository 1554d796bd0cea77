// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/confirmations.hpp"

#include <chrono>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Duration kTolerance = milliseconds(250);
constexpr UtcTime kSent{seconds(1'800'000'000)};

struct ConfirmationsTest : testing::Test {
  UtcTime utc() const { return kSent + (now - SteadyTime(seconds(100))); }
  /// A client waits for a command, which is sent.
  void send(CommandKind kind, std::uint64_t id) {
    sut.wait_for(1, kind, now);
    sut.on_sent({.kind = kind, .id = id, .stamp = utc()});
  }
  void report(std::uint32_t robot, RobotMode mode, std::uint64_t id) {
    sut.on_status(RobotId(robot), {.mode = mode, .command_id = id, .stamp = utc()}, utc());
  }
  void all(RobotMode mode, std::uint64_t id) {
    now += milliseconds(100);
    for (std::uint32_t robot = 0; robot < 3; ++robot) report(robot, mode, id);
  }
  /// The answer that is due; empty if none is.
  std::string answer(const std::vector<RobotId>& lost = {}) {
    const auto answers = sut.due(lost, now);
    return answers.empty() ? "" : answers.front().text;
  }

  Confirmations sut{3, kTolerance};
  SteadyTime now{seconds(100)};
};

TEST_F(ConfirmationsTest, ComeFromStatusesThatNameTheCommand) {
  send(CommandKind::kPause, 7);
  all(RobotMode::kHolding, 6);
  EXPECT_EQ(answer(), "") << "these hold for another reason, and may move again";
  all(RobotMode::kMoving, 7);
  EXPECT_EQ(answer(), "");
  all(RobotMode::kHolding, 7);
  EXPECT_EQ(answer(), "done: 3 robots confirmed the pause");
  EXPECT_EQ(answer(), "") << "each is answered once";
}

TEST_F(ConfirmationsTest, AreNotOfACommandThatWasNotSent) {
  sut.wait_for(1, CommandKind::kPause, now);
  sut.on_sent({.kind = CommandKind::kStart, .id = 5, .stamp = utc()});
  all(RobotMode::kHolding, 5);
  EXPECT_EQ(answer(), "");
}

TEST_F(ConfirmationsTest, NameTheNewestOfTwoEqualCommands) {
  send(CommandKind::kPause, 7);
  send(CommandKind::kPause, 8);
  all(RobotMode::kHolding, 8);
  EXPECT_EQ(sut.due({}, now).size(), 2U);
}

TEST_F(ConfirmationsTest, FitTheCommand) {
  const struct {
    CommandKind kind;
    RobotMode before, after;
  } cases[] = {{CommandKind::kStart, RobotMode::kWaiting, RobotMode::kMoving},
               {CommandKind::kPause, RobotMode::kMoving, RobotMode::kHolding},
               {CommandKind::kPause, RobotMode::kMoving, RobotMode::kArrived},
               {CommandKind::kResume, RobotMode::kHolding, RobotMode::kMoving},
               {CommandKind::kResume, RobotMode::kHolding, RobotMode::kStopped}};
  std::uint64_t id = 0;
  for (const auto& c : cases) {
    send(c.kind, ++id);
    all(c.before, id);
    EXPECT_EQ(answer(), "") << to_string(c.kind);
    all(c.after, id);
    EXPECT_NE(answer(), "") << to_string(c.kind);
  }
}

TEST_F(ConfirmationsTest, AreNeitherExpectedNorCountedOfLostRobots) {
  send(CommandKind::kPause, 7);
  now += milliseconds(100);
  report(0, RobotMode::kHolding, 7);
  report(2, RobotMode::kHolding, 7);
  EXPECT_EQ(answer(), "");
  EXPECT_EQ(answer({RobotId(2)}), "") << "robot 1 has not confirmed";
  EXPECT_EQ(answer({RobotId(1)}), "done: 2 robots confirmed the pause");
}

TEST_F(ConfirmationsTest, AreMissedInTheEnd) {
  send(CommandKind::kPause, 7);
  now += milliseconds(100);
  report(0, RobotMode::kHolding, 7);
  now += Confirmations::kTimeout;
  EXPECT_EQ(answer(), "failed: only 1 of 3 robots confirmed the pause within 5 s");
}

TEST(ConfirmationsOfAStatus, AreFresh) {
  constexpr SentCommand kPause{.kind = CommandKind::kPause, .id = 7, .stamp = kSent};
  constexpr UtcTime kNow = kSent + seconds(1);
  const auto at = [&](UtcTime stamp) {
    return confirms({.mode = RobotMode::kHolding, .command_id = 7, .stamp = stamp}, kPause, kNow,
                    kTolerance);
  };
  EXPECT_TRUE(at(kSent));
  EXPECT_TRUE(at(kSent - kTolerance)) << "the robot's clock may be behind";
  EXPECT_FALSE(at(kSent - kTolerance - milliseconds(1))) << "published before the command";
  EXPECT_TRUE(at(kNow + kTolerance));
  EXPECT_FALSE(at(kNow + kTolerance + milliseconds(1))) << "published in the future";
}

TEST(ConfirmationsOfAStatus, NameTheStopOrAnyLaterOne) {
  constexpr SentCommand kStop{.kind = CommandKind::kStop, .id = 7, .stamp = kSent};
  const auto of = [&](RobotMode mode, std::uint64_t id) {
    return confirms({.mode = mode, .command_id = id, .stamp = kSent}, kStop, kSent, kTolerance);
  };
  EXPECT_FALSE(of(RobotMode::kStopped, 6)) << "it stopped by itself, or for another stop";
  EXPECT_TRUE(of(RobotMode::kStopped, 7));
  EXPECT_TRUE(of(RobotMode::kStopped, 8)) << "a stop is final";
  EXPECT_FALSE(of(RobotMode::kMoving, 7));
}

}  // namespace
}  // namespace swarm::launcher
