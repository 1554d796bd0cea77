// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/gate/status_owners.hpp"

#include <chrono>

#include <gtest/gtest.h>

namespace swarm::link {
namespace {

using std::chrono::seconds;

constexpr UtcTime kBegin{seconds(1'800'000'000)};
constexpr std::uint64_t kRobots = 11, kForger = 12;

struct StatusOwnersTest : testing::Test {
  /// A status of robots 3 and 4, published and received now.
  Checked<void> receive(std::uint64_t sender, std::uint32_t first = 3) {
    return sut.accept({.first_robot_id = first,
                       .stamp_utc_ns = now.time_since_epoch().count(),
                       .robots = {{.robot_id = first}, {.robot_id = first + 1}}},
                      {sender, now});
  }
  static bool is(const Checked<void>& checked, RefusalReason reason) {
    return !checked && checked.error() == reason;
  }

  StatusOwners sut{seconds(10)};
  UtcTime now = kBegin;
};

TEST_F(StatusOwnersTest, BelongToTheFirstSender) {
  EXPECT_TRUE(receive(kRobots));
  EXPECT_TRUE(is(receive(kForger), RefusalReason::kForged));
  EXPECT_TRUE(is(receive(kForger, 2), RefusalReason::kForged)) << "robot 3 is not its own";
  EXPECT_TRUE(is(receive(kForger, 4), RefusalReason::kForged));
  EXPECT_TRUE(receive(kRobots));
  EXPECT_TRUE(receive(kForger, 5)) << "5 and 6 are free: refused statuses own nothing";
}

TEST_F(StatusOwnersTest, PassToAnotherSenderAfterASilence) {
  EXPECT_TRUE(receive(kRobots));
  now += seconds(10);
  EXPECT_TRUE(is(receive(kForger), RefusalReason::kForged));
  now += seconds(1);
  EXPECT_TRUE(receive(kForger));
  EXPECT_TRUE(is(receive(kRobots), RefusalReason::kForged));
}

TEST_F(StatusOwnersTest, PassToTheNextProcessAtOnce) {
  EXPECT_TRUE(receive(kRobots));
  sut.release(RobotId(3), now);
  sut.release(RobotId(4), now);
  EXPECT_TRUE(is(receive(kRobots), RefusalReason::kStale)) << "sent before the process ended";
  now += seconds(1);
  EXPECT_TRUE(receive(kForger)) << "the next process";
  EXPECT_TRUE(is(receive(kRobots), RefusalReason::kForged));
}

TEST_F(StatusOwnersTest, AreNotCheckedWhereTheSenderIsUnknown) {
  EXPECT_TRUE(receive(0));
  EXPECT_TRUE(receive(kRobots)) << "an unknown sender owns nothing";
  EXPECT_TRUE(receive(0));
}

}  // namespace
}  // namespace swarm::link
