// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/hosts/start_queue.hpp"

#include <chrono>
#include <optional>

#include <gtest/gtest.h>

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;
SteadyTime at(int ms) { return SteadyTime(std::chrono::hours(1) + milliseconds(ms)); }

TEST(StartQueue, StartsOneProcessAfterTheOther) {
  StartQueue sut(3);
  sut.add(0);
  sut.add(10);

  EXPECT_EQ(sut.next(at(0)), 0U);
  EXPECT_EQ(sut.next(at(49)), std::nullopt) << "starting processes compete";
  EXPECT_EQ(sut.next(at(50)), 10U);
  EXPECT_TRUE(sut.is_empty());
  EXPECT_EQ(sut.next(at(1000)), std::nullopt);
}

TEST(StartQueue, WaitsLongerAfterEachDeathInARow) {
  StartQueue sut(3);
  sut.add(0);
  ASSERT_EQ(sut.next(at(0)), 0U);

  EXPECT_TRUE(sut.on_exit(0, at(100)));
  EXPECT_EQ(sut.next(at(399)), std::nullopt);
  EXPECT_EQ(sut.next(at(400)), 0U);
  EXPECT_TRUE(sut.on_exit(0, at(500)));
  EXPECT_FALSE(sut.is_empty());
  EXPECT_EQ(sut.next(at(1099)), std::nullopt);
  EXPECT_EQ(sut.next(at(1100)), 0U);
}

TEST(StartQueue, OneThatWaitsHoldsUpNoOther) {
  StartQueue sut(3);
  sut.add(0);
  ASSERT_EQ(sut.next(at(0)), 0U);
  EXPECT_TRUE(sut.on_exit(0, at(100)));
  sut.add(10);

  EXPECT_EQ(sut.next(at(200)), 10U);
  EXPECT_EQ(sut.next(at(400)), 0U);
}

TEST(StartQueue, GivesUpAProcessThatDiesTooOftenInARowAndNoOther) {
  StartQueue sut(1);
  sut.add(0);
  sut.add(10);
  ASSERT_EQ(sut.next(at(0)), 0U);
  ASSERT_EQ(sut.next(at(50)), 10U);

  EXPECT_TRUE(sut.on_exit(0, at(1000)));
  ASSERT_EQ(sut.next(at(2000)), 0U);
  EXPECT_FALSE(sut.on_exit(0, at(3000)));
  EXPECT_TRUE(sut.on_exit(10, at(3000)));
}

TEST(StartQueue, ADeathAfterTwentySecondsIsTheFirstAgain) {
  StartQueue sut(1);
  sut.add(0);
  for (int death = 0; death < 5; ++death) {
    const int started = death * 100'000;
    ASSERT_EQ(sut.next(at(started)), 0U);
    EXPECT_TRUE(sut.on_exit(0, at(started + 20'000)));
  }
}

}  // namespace
}  // namespace swarm::launcher
