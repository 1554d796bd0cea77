// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/neighbour_table.hpp"

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;

SteadyTime at(int ms) { return SteadyTime(milliseconds(ms)); }

NeighbourTable table() {
  return NeighbourTable({.radius_m = 0.2,
                         .fleet = Fleet(Fleet::Body{0.2, 1.5}),
                         .keep_radius_m = 6.0,
                         .near_m = 1.0,
                         .near_silence = milliseconds(300),
                         .expected_silence = milliseconds(700),
                         .forget_after = milliseconds(1000)});
}

NeighbourReport report(std::uint32_t robot, std::uint32_t sequence, int ms, Vec2 position,
                       Vec2 velocity = Vec2::Zero()) {
  return {RobotId(robot), sequence, at(ms), position, velocity};
}

TEST(NeighbourTable, ExtrapolatesAlongTheLastVelocity) {
  auto sut = table();
  sut.take(report(3, 1, 0, {2, 0}, {0.5, -1}), Vec2::Zero());

  const auto now = sut.at(at(400), Vec2::Zero());

  ASSERT_EQ(now.size(), 1U);
  EXPECT_NEAR(now[0].position_m.x(), 2.2, 1e-12);
  EXPECT_NEAR(now[0].position_m.y(), -0.4, 1e-12);
  EXPECT_DOUBLE_EQ(now[0].radius_m, 0.2);
}

TEST(NeighbourTable, TakesANearRobotThatFellSilentForStandingWhereItIsNearest) {
  auto ahead = table();
  ahead.take(report(3, 1, 0, {1, 0}, {1, 0}), Vec2::Zero());
  auto behind = table();
  behind.take(report(3, 1, 0, {-1, 0}, {1, 0}), Vec2::Zero());

  const auto stopped = ahead.at(at(600), Vec2::Zero());
  const auto going_on = behind.at(at(600), Vec2::Zero());

  ASSERT_EQ(stopped.size(), 1U);
  EXPECT_NEAR(stopped[0].position_m.x(), 1.3, 1e-12);  // where its driver stopped it, give or take
  EXPECT_EQ(stopped[0].velocity_mps, Vec2::Zero());
  ASSERT_EQ(going_on.size(), 1U);
  EXPECT_NEAR(going_on[0].position_m.x(), -0.4, 1e-12);
}

TEST(NeighbourTable, GrowsARobotThatIsSilentForTooLong) {
  auto sut = table();
  sut.take(report(3, 1, 0, {1, 0}), Vec2::Zero());

  const auto now = sut.at(at(900), Vec2::Zero());

  ASSERT_EQ(now.size(), 1U);
  EXPECT_NEAR(now[0].radius_m, 0.2 + 1.5 * 0.2, 1e-12);
}

TEST(NeighbourTable, ForgetsRobotsOlderThanTheHorizon) {
  auto sut = table();
  sut.take(report(3, 1, 0, {1, 0}), Vec2::Zero());

  EXPECT_TRUE(sut.at(at(1001), Vec2::Zero()).empty());
}

TEST(NeighbourTable, DropsWhoLeavesTheSensingRangeUnheard) {
  auto sut = table();
  sut.take(report(3, 1, 0, {5.9, 0}, {1, 0}), Vec2::Zero());
  sut.take(report(4, 1, 0, {5.9, 0}), Vec2::Zero());

  EXPECT_EQ(sut.at(at(200), Vec2::Zero()).size(), 1U);   // it went
  EXPECT_EQ(sut.at(at(200), Vec2(-0.2, 0)).size(), 0U);  // I went
  EXPECT_EQ(sut.at(at(200), Vec2::Zero()).size(), 0U);   // and must hear it again
}

TEST(NeighbourTable, RefusesOldAndRepeatedReports) {
  auto sut = table();
  sut.take(report(3, 5, 100, {1, 0}), Vec2::Zero());

  EXPECT_EQ(sut.take(report(3, 5, 100, {2, 0}), Vec2::Zero()), NeighbourTable::Outcome::kDuplicate);
  EXPECT_EQ(sut.take(report(3, 4, 200, {2, 0}), Vec2::Zero()), NeighbourTable::Outcome::kStale);
  EXPECT_EQ(sut.at(at(100), Vec2::Zero())[0].position_m.x(), 1.0);
}

TEST(NeighbourTable, AcceptsTheWrapOfTheSequence) {
  auto sut = table();
  sut.take(report(3, 0xFFFF'FFFF, 100, {1, 0}), Vec2::Zero());

  EXPECT_EQ(sut.take(report(3, 0, 200, {2, 0}), Vec2::Zero()), NeighbourTable::Outcome::kTaken);
}

TEST(NeighbourTable, LetsARestartedRobotStartOver) {
  auto sut = table();
  sut.take(report(3, 500, 0, {1, 0}), Vec2::Zero());

  EXPECT_EQ(sut.take(report(3, 1, 1500, {2, 0}), Vec2::Zero()), NeighbourTable::Outcome::kTaken);
}

TEST(NeighbourTable, DropsWhoLeavesTheNeighbourhood) {
  auto sut = table();
  sut.take(report(3, 1, 0, {1, 0}), Vec2::Zero());

  EXPECT_EQ(sut.take(report(3, 2, 10, {7, 0}), Vec2::Zero()), NeighbourTable::Outcome::kFar);
  EXPECT_TRUE(sut.at(at(10), Vec2::Zero()).empty());
}

}  // namespace
}  // namespace swarm::agent
