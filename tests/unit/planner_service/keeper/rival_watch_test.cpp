// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/keeper/rival_watch.hpp"

#include <chrono>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace swarm::planner {
namespace {

using Role = RivalWatch::Role;
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
  /// It has joined and leads.
  void lead() {
    receive_nothing(kTakeover + milliseconds(100));
    ASSERT_EQ(sut.role(), Role::kLeading);
    roles.clear();
  }
  void step() {
    if (const auto role = sut.step(now)) roles.push_back(*role);
  }

  SteadyTime now{std::chrono::seconds(100)};
  RivalWatch sut{kOwn, kTakeover, now};
  std::vector<Role> roles;
};

TEST_F(RivalWatchTest, LeadsAfterItHasReceivedNoOtherForTheTakeoverTime) {
  receive_nothing(kTakeover);
  EXPECT_EQ(sut.role(), Role::kJoining);
  receive_nothing(milliseconds(100));
  EXPECT_EQ(roles, (std::vector{Role::kLeading}));
}

TEST_F(RivalWatchTest, IgnoresItsOwnHeartbeats) {
  lead();
  receive(kOwn, milliseconds(3000));
  EXPECT_TRUE(roles.empty());
}

TEST_F(RivalWatchTest, StandsByForAnyPlannerThatBeatsWhenItJoins) {
  receive(kLater, milliseconds(2000));
  EXPECT_EQ(roles, (std::vector{Role::kStandingBy}));

  receive_nothing(2 * kTakeover - milliseconds(200));
  EXPECT_EQ(sut.role(), Role::kStandingBy);
  receive_nothing(milliseconds(400));
  EXPECT_EQ(roles, (std::vector{Role::kStandingBy, Role::kLeading}));
  sut.begin_epoch(kLater + 1);
  receive(kLater + 1, milliseconds(3000));
  EXPECT_EQ(sut.role(), Role::kLeading) << "its own heartbeats";
}

// The last heartbeats of a planner that has just died are not those of a rival.
TEST_F(RivalWatchTest, LeadsSoonAfterTheLastHeartbeatOfADeadOne) {
  receive(kEarlier, milliseconds(200));
  receive_nothing(2 * kTakeover + milliseconds(100));
  EXPECT_EQ(roles, (std::vector{Role::kLeading}));
}

TEST_F(RivalWatchTest, OfTwoThatLeadTheEarlierOneStays) {
  lead();
  receive(kLater, milliseconds(5000));
  EXPECT_TRUE(roles.empty());
  receive(kEarlier, milliseconds(1000));
  EXPECT_EQ(roles, (std::vector{Role::kStandingBy}));
}

// One or two forged heartbeats do not end a plan.
TEST_F(RivalWatchTest, CountsTheThirdHeartbeatInARow) {
  lead();
  receive(kEarlier, milliseconds(400));
  receive_nothing(milliseconds(1000));
  receive(kEarlier, milliseconds(400));
  EXPECT_TRUE(roles.empty());
  receive(kEarlier, milliseconds(200));
  EXPECT_EQ(roles, (std::vector{Role::kStandingBy}));
}

// It was replaced while it was suspended.
TEST_F(RivalWatchTest, StandsByAfterASuspensionForAPlannerThatTookOver) {
  lead();
  now += std::chrono::seconds(30);
  step();
  receive(kLater, milliseconds(1000));
  EXPECT_EQ(roles, (std::vector{Role::kStandingBy}));
}

TEST_F(RivalWatchTest, LeadsOnAfterASuspensionInWhichNoneTookOver) {
  lead();
  now += std::chrono::seconds(30);
  step();
  receive_nothing(milliseconds(3000));
  receive(kLater, milliseconds(3000));
  EXPECT_TRUE(roles.empty());
}

}  // namespace
}  // namespace swarm::planner
