// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/robot_agent/safety/contact_oracle.hpp"

#include <chrono>

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;
using Awareness = ContactOracle::Awareness;

SteadyTime at(int ms) { return SteadyTime(milliseconds(ms)); }

OracleOptions options(std::size_t robots) {
  return {.robots = robots,
          .radius_m = 0.2,
          .speed_mps = 1.5,
          .expected_silence = milliseconds(700),
          .stands_after = milliseconds(3600)};
}

/// Robots 0 and 1 receive each other's states of 0 ms, at (0, 0) and (x, 0).
class ContactOracleTest : public testing::Test {
 protected:
  void begin(double x_m) {
    sut_.on_received(0, 1, at(0), {x_m, 0});
    sut_.on_received(1, 0, at(0), {0, 0});
    x_m_ = x_m;
  }
  void cut_off(std::size_t from, std::size_t to) { sut_.on_lost(to, from); }
  /// Both stay where they were and tick.
  void tick(int ms) {
    sut_.on_tick(0, at(ms), {0, 0});
    sut_.on_tick(1, at(ms), {x_m_, 0});
  }

  ContactOracle sut_{options(2)};
  double x_m_ = 0.0;
};

TEST_F(ContactOracleTest, CountsBetweenHealthyRobots) {
  begin(1.0);
  tick(500);
  EXPECT_EQ(sut_.awareness(0, 1), Awareness::kReceiving);
  EXPECT_TRUE(sut_.counts(0, 1));
}

TEST_F(ContactOracleTest, DoesNotCountWhileNeitherCanKnow) {
  begin(1.0);
  cut_off(0, 1);
  cut_off(1, 0);
  tick(700);
  EXPECT_EQ(sut_.awareness(0, 1), Awareness::kUnaware);
  EXPECT_FALSE(sut_.counts(0, 1));
}

TEST_F(ContactOracleTest, CountsOnceBothCouldStand) {
  begin(1.0);
  cut_off(0, 1);
  cut_off(1, 0);
  sut_.on_tick(0, at(710), {0, 0});
  EXPECT_EQ(sut_.awareness(0, 1), Awareness::kWithin);
  EXPECT_FALSE(sut_.counts(0, 1)) << "robot 1 has not ticked since";
  tick(800);
  EXPECT_TRUE(sut_.counts(0, 1));
}

// At 710 ms a robot has reached 1.065 m: bodies touch up to 1.465 m.
TEST_F(ContactOracleTest, CountsWhereOneCouldOutrunTheOther) {
  begin(1.47);
  cut_off(0, 1);
  cut_off(1, 0);
  sut_.on_tick(0, at(710), {0, 0});
  EXPECT_EQ(sut_.awareness(0, 1), Awareness::kOutside);
  EXPECT_TRUE(sut_.counts(0, 1));
}

TEST_F(ContactOracleTest, CountsForAMuteRobotSinceItReceives) {
  begin(1.0);
  cut_off(0, 1);
  EXPECT_EQ(sut_.awareness(1, 0), Awareness::kUnaware);
  EXPECT_EQ(sut_.awareness(0, 1), Awareness::kReceiving);
  EXPECT_TRUE(sut_.counts(0, 1));
}

TEST_F(ContactOracleTest, CountsWithAFrozenRobotOnceItIsKnownToBeSilent) {
  begin(1.0);
  sut_.set_unable(1, true);
  sut_.on_tick(0, at(710), {0, 0});
  EXPECT_EQ(sut_.awareness(0, 1), Awareness::kWithin);
  EXPECT_TRUE(sut_.counts(0, 1)) << "robot 0 could stand as well";
}

TEST_F(ContactOracleTest, CountsWithAnAdversarialRobotThatIsReceivedOrCanBeOutrun) {
  begin(1.0);
  sut_.set_adversarial(1);
  EXPECT_TRUE(sut_.counts(0, 1));
  cut_off(1, 0);
  EXPECT_FALSE(sut_.counts(1, 0));
  tick(710);
  EXPECT_FALSE(sut_.counts(0, 1)) << "on which side is it?";
  begin(1.47);
  cut_off(1, 0);
  tick(710);
  EXPECT_TRUE(sut_.counts(0, 1));
}

TEST_F(ContactOracleTest, BeginsAnewWithEachStateReceived) {
  begin(1.0);
  cut_off(0, 1);
  tick(710);
  begin(1.0);
  EXPECT_EQ(sut_.awareness(1, 0), Awareness::kReceiving);
}

// Robot 0 is between two discs that it could outrun one by one.
TEST(ContactOracle, DoesNotBlameARobotThatTwoDiscsCloseInOn) {
  ContactOracle sut(options(3));
  sut.on_received(0, 1, at(0), {2, 0});
  sut.on_received(0, 2, at(100), {-2, 0});
  sut.on_tick(0, at(710), {0, 0});
  EXPECT_EQ(sut.awareness(0, 1), Awareness::kOutside);
  EXPECT_EQ(sut.awareness(0, 2), Awareness::kReceiving);
  sut.on_tick(0, at(810), {0, 0});
  EXPECT_EQ(sut.awareness(0, 1), Awareness::kWithin);
  EXPECT_EQ(sut.awareness(0, 2), Awareness::kWithin);
}

}  // namespace
}  // namespace swarm::agent
