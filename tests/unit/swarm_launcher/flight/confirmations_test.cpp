// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/confirmations.hpp"

#include <chrono>
#include <string>

#include <gtest/gtest.h>

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;

struct ConfirmationsTest : testing::Test {
  void all(RobotMode mode) {
    now += milliseconds(100);
    for (std::uint32_t robot = 0; robot < 3; ++robot) sut.on_status(RobotId(robot), mode, now);
  }
  /// The answer that is due; empty if none is.
  std::string answer(std::uint32_t lost = 0) {
    const auto answers = sut.due(lost, now);
    return answers.empty() ? "" : answers.front().text;
  }

  Confirmations sut{3};
  SteadyTime now{std::chrono::seconds(100)};
};

TEST_F(ConfirmationsTest, ComeFromStatusesAfterTheCommand) {
  all(RobotMode::kHolding);
  sut.wait_for(1, CommandKind::kPause, now);
  EXPECT_EQ(answer(), "") << "these held before, and may move again since";
  all(RobotMode::kMoving);
  EXPECT_EQ(answer(), "");
  all(RobotMode::kHolding);
  EXPECT_EQ(answer(), "done: 3 robots confirmed the pause");
  EXPECT_EQ(answer(), "") << "each is answered once";
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
  for (const auto& c : cases) {
    sut.wait_for(1, c.kind, now);
    all(c.before);
    EXPECT_EQ(answer(), "") << to_string(c.kind);
    all(c.after);
    EXPECT_NE(answer(), "") << to_string(c.kind);
  }
}

TEST_F(ConfirmationsTest, AreNotExpectedOfLostRobots) {
  sut.wait_for(1, CommandKind::kPause, now);
  now += milliseconds(100);
  sut.on_status(RobotId(0), RobotMode::kHolding, now);
  sut.on_status(RobotId(2), RobotMode::kHolding, now);
  EXPECT_EQ(answer(), "");
  EXPECT_EQ(answer(1), "done: 2 robots confirmed the pause");
}

TEST_F(ConfirmationsTest, AreMissedInTheEnd) {
  sut.wait_for(1, CommandKind::kPause, now);
  now += milliseconds(100);
  sut.on_status(RobotId(0), RobotMode::kHolding, now);
  now += Confirmations::kTimeout;
  EXPECT_EQ(answer(), "failed: only 1 of 3 robots confirmed the pause within 5 s");
}

}  // namespace
}  // namespace swarm::launcher
