// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/neighbours/silent_robots.hpp"

#include <chrono>

#include <gtest/gtest.h>

#include "robot_agent/neighbours/neighbour_table.hpp"

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

SteadyTime at(int ms) { return SteadyTime(milliseconds(ms)); }

/// Robot 0 is our own; the others have 0.7 s, and 2.2 s until their dead-man has stopped them.
SilenceOptions options() {
  return {.fleet = Fleet(Fleet::Body{0.2, 1.5}),
          .robots = 5,
          .own = 1,
          .expected_silence = milliseconds(700),
          .dead_man = milliseconds(2200)};
}
WhereaboutsOptions clears() {
  return {.robots = 5,
          .beat_timeout = milliseconds(1500),
          .launcher_silence = seconds(3),
          .healthy_after = seconds(6)};
}

SilentRobots::State state(std::uint32_t robot, int ms, Vec2 position_m,
                          Vec2 velocity_mps = Vec2::Zero()) {
  return {RobotId(robot), at(ms), position_m, velocity_mps};
}

TEST(SilentRobots, StandForEverWithinWhatTheirDeadManAllows) {
  SilentRobots sut(options());
  const Whereabouts nothing(clears());
  sut.on_state(state(3, 0, {2, 0}, {1, 0}));

  sut.update(at(700), nothing);
  EXPECT_TRUE(sut.all().empty()) << "a healthy robot may be silent for this long";
  sut.update(at(1000), nothing);
  ASSERT_EQ(sut.all().size(), 1U);
  EXPECT_EQ(sut.all()[0].robot, RobotId(3));
  EXPECT_NEAR(sut.all()[0].from_m.x(), 2.0, 1e-9);
  EXPECT_NEAR(sut.all()[0].to_m.x(), 2.7, 1e-9) << "it may have followed its course for 0.7 s";
  EXPECT_NEAR(sut.all()[0].radius_m, 0.2 + 2 * 1.5 * 0.3, 1e-9);
  EXPECT_EQ(sut.all()[0].growth_mps, 3.0);
  sut.update(at(2000), nothing);
  EXPECT_NEAR(sut.all()[0].radius_m, 0.2 + 1.5 * 2.0, 1e-9) << "or turned at once";
  EXPECT_EQ(sut.all()[0].growth_mps, 1.5);
  for (const int ms : {2900, 10'000, 100'000'000}) {
    sut.update(at(ms), nothing);
    ASSERT_EQ(sut.all().size(), 1U);
    EXPECT_NEAR(sut.all()[0].radius_m, 0.2 + 1.5 * 2.9, 1e-9) << ms;
    EXPECT_EQ(sut.all()[0].to_m, Vec2(2.0, 0.0));
    EXPECT_EQ(sut.all()[0].growth_mps, 0.0);
  }
}

TEST(SilentRobots, AreNoLongerSilentOnceReceivedFromAnywhere) {
  SilentRobots sut(options());
  const Whereabouts nothing(clears());
  sut.on_state(state(3, 0, {2, 0}));
  sut.on_state(state(4, 0, {1, 0}));
  sut.update(at(2000), nothing);
  ASSERT_EQ(sut.all().size(), 2U);

  sut.on_state(state(3, 1900, {50, 0}));
  sut.on_state(state(4, -500, {1, 0}));  // out of date
  sut.update(at(2000), nothing);

  ASSERT_EQ(sut.all().size(), 1U);
  EXPECT_EQ(sut.all()[0].robot, RobotId(4));
}

TEST(SilentRobots, AreClearedByTheirBodyInTheSceneAndByTheLaunchersBeats) {
  SilentRobots sut(options());
  Whereabouts whereabouts(clears());
  Scene scene = first_scene(0);
  scene.obstacles.push_back({.id = 0, .owner = RobotId(3), .shape = Circle{{2, 0}, 0.3}});
  for (const std::uint32_t robot : {2U, 3U, 4U}) sut.on_state(state(robot, 0, {2, 0}));
  whereabouts.on_scene(scene);
  sut.update(at(1000), whereabouts);
  EXPECT_EQ(sut.all().size(), 2U) << "robot 3 is an obstacle";
  whereabouts.on_scene(first_scene(0));
  sut.update(at(1000), whereabouts);
  EXPECT_EQ(sut.all().size(), 3U) << "the launcher receives it again, but here it is still silent";
  whereabouts.on_scene(scene);

  link::LauncherBeat beat;
  for (int ms = 1000; ms <= 7000; ms += 500) {
    ++beat.sequence;
    link::set_silent(beat, std::vector{RobotId(4)});
    whereabouts.on_beat(beat, at(ms));
    sut.update(at(ms), whereabouts);
    EXPECT_EQ(sut.all().size(), ms < 7000 ? 2U : 1U) << ms;
  }

  EXPECT_EQ(sut.all()[0].robot, RobotId(4)) << "which the launcher does not receive either";
}

TEST(SilentRobots, AreNeverThoseOfTheProcessNorUnknownOnes) {
  SilentRobots sut(options());
  const Whereabouts nothing(clears());
  sut.on_state(state(0, 0, {2, 0}));
  sut.on_state(state(5, 0, {2, 0}));
  sut.update(at(9000), nothing);
  EXPECT_TRUE(sut.all().empty());
}

// What a neighbour table makes of them.
TEST(SilentRobots, AreNeighboursWhereTheyMayBeWithinReach) {
  const auto table_options = [] {
    return NeighbourOptions{.fleet = Fleet(Fleet::Body{0.2, 1.5}),
                            .communication_radius_m = 6.0,
                            .reach_m = 4.0,
                            .close_m = 2.0,
                            .period = milliseconds(100),
                            .expected_silence = milliseconds(700),
                            .forget_after = milliseconds(2000)};
  };
  NeighbourTable table(table_options());
  SilentRobots silent(options());
  const Whereabouts nothing(clears());
  const auto publish = [&](std::uint32_t robot, Vec2 position_m) {
    table.take({RobotId(robot), 1, at(0), position_m, Vec2::Zero()}, Vec2::Zero());
    silent.on_state(state(robot, 0, position_m));
  };
  publish(1, {0, 3.5});
  publish(2, {0, 5.9});
  publish(3, {0, 9.0});

  silent.update(at(600), nothing);
  EXPECT_EQ(table.at(at(600), Vec2::Zero(), &silent).all.size(), 1U) << "one is in reach";
  silent.update(at(5000), nothing);
  const Neighbourhood near = table.at(at(5000), Vec2::Zero(), &silent);

  ASSERT_EQ(near.all.size(), 2U) << "robot 3 is at least 4.6 m away";
  ASSERT_EQ(near.close.size(), 2U);
  EXPECT_EQ(near.close[0].robot, RobotId(1));
  EXPECT_NEAR(near.close[0].radius_m, 4.55, 1e-9);
  EXPECT_EQ(near.close[0].velocity_mps, Vec2(Vec2::Zero()));
  EXPECT_EQ(near.close[1].robot, RobotId(2));
  EXPECT_TRUE(table.at(at(5000), Vec2::Zero()).all.empty()) << "without them they are forgotten";
}

TEST(SilentRobots, ReplaceWhatTheTableExtrapolatesAndApproachWhileTheyGrow) {
  NeighbourTable table(NeighbourOptions{.fleet = Fleet(Fleet::Body{0.2, 1.5}),
                                        .communication_radius_m = 6.0,
                                        .period = milliseconds(100),
                                        .expected_silence = milliseconds(700),
                                        .forget_after = milliseconds(2000)});
  SilentRobots silent(options());
  table.take({RobotId(1), 1, at(0), {0, 2}, {0, -1}}, Vec2::Zero());
  silent.on_state(state(1, 0, {0, 2}, {0, -1}));
  silent.update(at(1000), Whereabouts(clears()));

  const auto near = table.at(at(1000), Vec2::Zero(), &silent).all;

  ASSERT_EQ(near.size(), 1U) << "once";
  EXPECT_NEAR(near[0].position_m.y(), 1.3, 1e-9) << "the nearest point of its course";
  EXPECT_NEAR(near[0].velocity_mps.y(), -3.0, 1e-9);
}

}  // namespace
}  // namespace swarm::agent
