// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/app/run_clock.hpp"

#include <chrono>

#include <gtest/gtest.h>

#include "swarm_core/base/clock.hpp"

namespace swarm::shell {
namespace {

/// The offset is that of the whole process: each test puts it back.
struct RunClockTest : testing::Test {
  ~RunClockTest() override { follow(before); }
  RunClock before = own_clock();
};

TEST_F(RunClockTest, IsTheWallClockAtFirst) {
  const Duration off = utc_now() - wall_clock_now();
  EXPECT_LT(std::chrono::abs(off), std::chrono::seconds(60)) << "unless the clock is set";
  EXPECT_FALSE(before.boot_id.empty());
}

TEST_F(RunClockTest, IsFollowedByProcessesOfTheSameMachine) {
  RunClock run = before;
  run.utc_minus_steady_ns -= 3'600'000'000'000;

  ASSERT_TRUE(follow(run));

  EXPECT_EQ(own_clock().utc_minus_steady_ns, run.utc_minus_steady_ns);
  const auto expected = std::chrono::steady_clock::now().time_since_epoch() +
                        Duration(run.utc_minus_steady_ns) - utc_now().time_since_epoch();
  EXPECT_LT(std::chrono::abs(expected), std::chrono::seconds(10));
}

TEST_F(RunClockTest, OfAnotherMachineIsNotFollowed) {
  EXPECT_FALSE(follow(RunClock{.boot_id = "another", .utc_minus_steady_ns = 5}));
  EXPECT_FALSE(follow(RunClock{.boot_id = "", .utc_minus_steady_ns = 5}));
  EXPECT_EQ(own_clock().utc_minus_steady_ns, before.utc_minus_steady_ns);
}

TEST_F(RunClockTest, IsTakenFromAMessageOfAnotherMachine) {
  const SteadyTime then(std::chrono::seconds(500));
  follow(UtcTime(std::chrono::seconds(1'700'000'000)), then);
  EXPECT_EQ(own_clock().utc_minus_steady_ns, 1'699'999'500'000'000'000);
}

}  // namespace
}  // namespace swarm::shell
