// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/keeper/rival_watch.hpp"

#include <chrono>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace swarm::planner {
namespace {

using Change = RivalWatch::Change;
using std::chrono::milliseconds;

constexpr Duration kTakeover = milliseconds(700);
constexpr std::uint64_t kOwn = 50, kEarlier = 40, kLater = 60;

struct RivalWatchTest : testing::Test {
  /// Heartbeats of a rival at 5 Hz for a while; steps of the planner in between.
  void receive(std::uint64_t epoch, Duration span) {
    for (const SteadyTime until = now + span; now < until;) {
      now += milliseconds(200);
      sut.on_heartbeat(epoch, now);
      step();
    }
  }
  void receive_nothing(Duration span) {
    for (const SteadyTime until = now + span; now < until;) {
      now += milliseconds(100);
      step();
    }
  }
  void step() {
    if (const auto change = sut.step(now)) changes.push_back(*change);
  }

  SteadyTime now{std::chrono::seconds(100)};
  RivalWatch sut{kOwn, kTakeover, now};
  std::vector<Change> changes;
};

TEST_F(RivalWatchTest, LeadsAloneAndIgnoresItsOwn) {
  receive(kOwn, milliseconds(3000));
  EXPECT_TRUE(changes.empty());
  EXPECT_FALSE(sut.stands_by());
}

TEST_F(RivalWatchTest, StandsByForAPlannerThatBeganBeforeAndTakesOverWhenItIsSilent) {
  receive(kEarlier, milliseconds(2000));
  EXPECT_EQ(changes, (std::vector{Change::kStoodBy}));
  EXPECT_TRUE(sut.stands_by());

  receive_nothing(2 * kTakeover - milliseconds(200));
  EXPECT_TRUE(sut.stands_by());
  receive_nothing(milliseconds(400));
  EXPECT_EQ(changes, (std::vector{Change::kStoodBy, Change::kTookOver}));
}

TEST_F(RivalWatchTest, LeadsOnWhenALaterOneBeats) {
  receive(kLater, milliseconds(5000));
  EXPECT_TRUE(changes.empty());
}

// One or two forged heartbeats do not end a plan.
TEST_F(RivalWatchTest, CountsTheThirdHeartbeatInARow) {
  receive(kEarlier, milliseconds(400));
  EXPECT_TRUE(changes.empty());
  receive_nothing(milliseconds(1000));
  receive(kEarlier, milliseconds(400));
  EXPECT_TRUE(changes.empty());
  receive(kEarlier, milliseconds(200));
  EXPECT_EQ(changes, (std::vector{Change::kStoodBy}));
}

// It was replaced while it was suspended.
TEST_F(RivalWatchTest, StandsByAfterASuspensionForAPlannerThatTookOver) {
  now += std::chrono::seconds(30);
  step();
  receive(kLater, milliseconds(1000));
  EXPECT_EQ(changes, (std::vector{Change::kStoodBy}));
}

TEST_F(RivalWatchTest, LeadsOnAfterASuspensionInWhichNoneTookOver) {
  now += std::chrono::seconds(30);
  step();
  receive_nothing(milliseconds(3000));
  receive(kLater, milliseconds(3000));
  EXPECT_TRUE(changes.empty());
}

}  // namespace
}  // namespace swarm::planner
