// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/neighbours/silent_robots.hpp"

#include <chrono>
#include <vector>

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
          .frozen_body_radius_m = std::vector(5, 2.0),
          .expected_silence = milliseconds(700),
          .expected_status = milliseconds(1100),
          .dead_man = milliseconds(2200)};
}
WhereaboutsOptions clears() {
  return {.robots = 5,
          .beat_timeout = milliseconds(1500),
          .launcher_silence = seconds(3),
          .healthy_after = seconds(6),
          .alive_after = milliseconds(1500)};
}

SilentRobots::State state(std::uint32_t robot, int ms, Vec2 position_m) {
  return {RobotId(robot), at(ms), position_m};
}

TEST(SilentRobots, StandForEverWithinWhatTheirDeadManAllows) {
  SilentRobots sut(options());
  const Whereabouts nothing(clears());
  sut.on_state(state(3, 0, {2, 0}));

  sut.update(at(700), nothing);
  EXPECT_TRUE(sut.all().empty()) << "a healthy robot may be silent for this long";
  sut.update(at(1000), nothing);
  ASSERT_EQ(sut.all().size(), 1U);
  EXPECT_EQ(sut.all()[0].robot, RobotId(3));
  EXPECT_EQ(sut.all()[0].centre_m, Vec2(2.0, 0.0));
  EXPECT_NEAR(sut.all()[0].radius_m, 0.2 + 1.5 * 1.0, 1e-9) << "it may have turned at once";
  EXPECT_EQ(sut.all()[0].growth_mps, 1.5);
  sut.update(at(2000), nothing);
  EXPECT_NEAR(sut.all()[0].radius_m, 0.2 + 1.5 * 2.0, 1e-9);
  EXPECT_EQ(sut.all()[0].growth_mps, 1.5);
  for (const int ms : {2900, 10'000, 100'000'000}) {
    sut.update(at(ms), nothing);
    ASSERT_EQ(sut.all().size(), 1U);
    EXPECT_NEAR(sut.all()[0].radius_m, 0.2 + 1.5 * 2.9, 1e-9) << ms;
    EXPECT_EQ(sut.all()[0].centre_m, Vec2(2.0, 0.0));
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
  scene.obstacles.push_back({.id = 0, .owner = RobotId(3), .shape = Circle{{2, 0}, 0.2}});
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
    whereabouts.on_beat(beat, at(ms), at(ms));
    sut.update(at(ms), whereabouts);
    EXPECT_EQ(sut.all().size(), ms < 7000 ? 2U : 1U) << ms;
  }

  EXPECT_EQ(sut.all()[0].robot, RobotId(4)) << "which the launcher does not receive either";
}

TEST(SilentRobots, StaySilentWhileTheirBodyIsOnlyKnownToBeInAWideCircle) {
  for (const double radius_m : {2.0, 2.1}) {
    SilentRobots sut(options());  // up to 2 m, a circle shows that the robot froze
    Whereabouts whereabouts(clears());
    Scene scene = first_scene(0);
    scene.obstacles.push_back({.id = 0, .owner = RobotId(3), .shape = Circle{{2, 0}, radius_m}});
    whereabouts.on_scene(scene);
    sut.on_state(state(3, 0, {2, 0}));

    sut.update(at(1000), whereabouts);

    EXPECT_EQ(sut.all().size(), radius_m > 2.0 ? 1U : 0U) << radius_m;
    sut.update(at(16'000), whereabouts);
    EXPECT_TRUE(sut.all().empty()) << "it stands somewhere in the circle; others leave it";
  }
}

// Robot 3 was received last from a cell that the process does not receive any more.
TEST(SilentRobots, AreNotThoseThatLeftTheCellsThatAreReceived) {
  SilentRobots sut(options());
  const Whereabouts nothing(clears());
  double received_up_to_m = 5.0;
  const auto receives_at = [&](const Vec2& position_m) {
    return position_m.x() < received_up_to_m;
  };
  sut.on_state(state(3, 0, {6, 0}));
  sut.on_state(state(4, 0, {4, 0}));

  sut.update(at(2000), nothing, receives_at);
  ASSERT_EQ(sut.all().size(), 1U);
  EXPECT_EQ(sut.all()[0].robot, RobotId(4));

  received_up_to_m = 7.0;
  sut.update(at(2600), nothing, receives_at);
  EXPECT_EQ(sut.all().size(), 1U) << "a healthy robot need not have published since";
  sut.update(at(2800), nothing, receives_at);
  ASSERT_EQ(sut.all().size(), 2U) << "its cell is received again, but it is not";
  EXPECT_EQ(sut.all()[0].robot, RobotId(3));
  EXPECT_NEAR(sut.all()[0].radius_m, 0.2 + 1.5 * 2.8, 1e-9) << "since its last state";

  received_up_to_m = 0.0;
  sut.update(at(2900), nothing, receives_at);
  EXPECT_EQ(sut.all().size(), 2U) << "retreating from a disc does not end it";

  sut.on_state(state(3, 2900, {6, 0}));
  sut.update(at(4000), nothing, receives_at);
  EXPECT_EQ(sut.all().size(), 1U) << "received in between, it has left again";
}

/// Robots that were never received here; the launcher's beats list them as late.
class LateRobots : public testing::Test {
 protected:
  void beat(int ms, const std::vector<link::LateRobot>& late) {
    ++beat_.sequence;
    link::set_late(beat_, late);
    ASSERT_TRUE(whereabouts_.on_beat(beat_, at(ms), at(ms)));
    sut_.on_beat(beat_, at(ms));
  }
  std::size_t silent(int ms, bool is_received_there) {
    sut_.update(at(ms), whereabouts_, [=](const Vec2&) { return is_received_there; });
    return sut_.all().size();
  }

  SilentRobots sut_{options()};
  Whereabouts whereabouts_{clears()};
  link::LauncherBeat beat_;
};

TEST_F(LateRobots, AreSilentWhereTheirCellsAreReceived) {
  beat(10'000, {{.robot = 3, .age_ms = 1300, .x_m = 2.0, .y_m = 1.0}});

  EXPECT_EQ(silent(10'000, false), 0U);
  EXPECT_EQ(silent(10'200, true), 0U) << "a healthy robot need not have published since";
  ASSERT_EQ(silent(10'800, true), 1U);
  EXPECT_EQ(sut_.all()[0].robot, RobotId(3));
  EXPECT_EQ(sut_.all()[0].centre_m, Vec2(2.0, 1.0));
  EXPECT_NEAR(sut_.all()[0].radius_m, 0.2 + 1.5 * 2.1, 1e-9) << "since its last status";
}

TEST_F(LateRobots, AreSilentAtOnceInACellThatHasBeenReceivedForLong) {
  beat(10'000, {{.robot = 3, .age_ms = 1300}});
  EXPECT_EQ(silent(10'000, true), 1U);
}

TEST_F(LateRobots, CanHaveDrivenForAPeriodOfTheirStatusesBeforeTheyWereCutOff) {
  for (int ms = 10'000; ms <= 14'000; ms += 1000) {
    beat(ms, {{.robot = 3, .age_ms = static_cast<std::uint32_t>(ms - 8'700)}});
    ASSERT_EQ(silent(ms, true), 1U);
  }
  EXPECT_NEAR(sut_.all()[0].radius_m, 0.2 + 1.5 * (1.1 + 2.2), 1e-9);
  EXPECT_EQ(sut_.all()[0].growth_mps, 0.0);
}

TEST_F(LateRobots, AreForgottenOnceTheLauncherReceivesThemAgain) {
  for (const bool is_received_there : {false, true}) {
    beat(10'000, {{.robot = 3, .age_ms = 1300}});
    EXPECT_EQ(silent(10'100, is_received_there), is_received_there ? 1U : 0U);
    beat(10'500, {});
    EXPECT_EQ(silent(10'500, is_received_there), 0U);
    EXPECT_EQ(silent(11'500, true), 0U);
    beat_ = {.sequence = beat_.sequence};
  }
}

TEST_F(LateRobots, AreKeptWhileBeatsDoNotListAllOrStop) {
  beat(10'000, {{.robot = 3, .age_ms = 1300}});
  beat(10'500, std::vector<link::LateRobot>(link::LauncherBeat::kMaxLate + 1, {.robot = 4}));
  EXPECT_EQ(silent(10'500, false), 0U);
  EXPECT_EQ(silent(20'000, true), 2U);
}

TEST_F(LateRobots, WereReceivedHereLater) {
  sut_.on_state(state(3, 9'500, {5, 0}));
  beat(10'000, {{.robot = 3, .age_ms = 1300, .x_m = 2.0}});
  EXPECT_EQ(silent(10'100, true), 0U);
  beat(10'500, {});
  ASSERT_EQ(silent(10'600, true), 1U) << "received once: it stays";
  EXPECT_EQ(sut_.all()[0].centre_m, Vec2(5.0, 0.0));
}

TEST_F(LateRobots, AreReceivedHereByAnOlderState) {
  beat(10'000, {{.robot = 3, .age_ms = 1300, .x_m = 2.0}});
  sut_.on_state(state(3, 8'600, {5, 0}));
  ASSERT_EQ(silent(10'000, true), 1U);
  EXPECT_EQ(sut_.all()[0].centre_m, Vec2(2.0, 0.0));
}

TEST_F(LateRobots, MoveTheDiscOfARobotThatIsSilentHereToTheirLastStatus) {
  sut_.on_state(state(3, 7'000, {5, 0}));
  EXPECT_EQ(silent(8'700, true), 1U);
  beat(10'000, {{.robot = 3, .age_ms = 1300, .x_m = 4.0}});
  ASSERT_EQ(silent(10'000, true), 1U);
  EXPECT_EQ(sut_.all()[0].centre_m, Vec2(4.0, 0.0));
  EXPECT_NEAR(sut_.all()[0].radius_m, 0.2 + 1.5 * 1.3, 1e-9);
}

// A robot that has left the cells that are received is forgotten once the launcher has received it.
TEST_F(LateRobots, AreNotThoseThatLeftAndAreReceivedByTheLauncherSince) {
  for (const int beat_ms : {11'400, 11'600}) {
    sut_.on_state(state(3, 10'000, {6, 0}));
    EXPECT_EQ(silent(beat_ms - 100, false), 0U);
    beat(beat_ms, {});
    EXPECT_EQ(silent(beat_ms, true), 0U);
    EXPECT_EQ(silent(beat_ms + 800, true), beat_ms < 11'500 ? 1U : 0U) << beat_ms;
    sut_ = SilentRobots(options());
  }
}

TEST(SilentRobots, AreNeverThoseOfTheProcessNorUnknownOnes) {
  SilentRobots sut(options());
  const Whereabouts nothing(clears());
  sut.on_state(state(0, 0, {2, 0}));
  sut.on_state(state(5, 0, {2, 0}));
  sut.update(at(9000), nothing);
  EXPECT_TRUE(sut.all().empty());
}

/// What a neighbour table makes of them.
NeighbourOptions table_options() {
  return {.radius_m = 0.2,
          .fleet = Fleet(Fleet::Body{0.2, 1.5}),
          .communication_radius_m = 12.0,
          .reach_m = 4.0,
          .close_m = 2.0,
          .period = milliseconds(100),
          .expected_silence = milliseconds(700),
          .forget_after = milliseconds(2000)};
}

TEST(SilentRobots, AreNeighboursWhereTheirDiscsAreWithinReach) {
  NeighbourTable table(table_options());
  SilentRobots silent(options());
  const Whereabouts nothing(clears());
  const auto publish = [&](std::uint32_t robot, Vec2 position_m) {
    table.take({RobotId(robot), 1, at(0), position_m, Vec2::Zero()}, Vec2::Zero());
    silent.on_state(state(robot, 0, position_m));
  };
  publish(1, {0, 5.0});
  publish(2, {0, 7.0});
  publish(3, {0, 9.0});

  silent.update(at(600), nothing);
  EXPECT_TRUE(table.at(at(600), Vec2::Zero(), &silent).all.empty()) << "none is in reach";
  silent.update(at(5000), nothing);
  const Neighbourhood near = table.at(at(5000), Vec2::Zero(), &silent);

  ASSERT_EQ(near.all.size(), 2U) << "robot 3 is at least 4.65 m away";
  ASSERT_EQ(near.close.size(), 1U);
  EXPECT_FALSE(near.is_within_silent);
  EXPECT_EQ(near.close[0].robot, RobotId(1));
  EXPECT_NEAR(near.close[0].radius_m, 4.55, 1e-9);
  EXPECT_EQ(near.close[0].velocity_mps, Vec2(Vec2::Zero()));
  EXPECT_EQ(near.all[1].robot, RobotId(2));
  EXPECT_TRUE(table.at(at(5000), Vec2::Zero()).all.empty()) << "without them they are forgotten";
}

TEST(SilentRobots, ReplaceWhatTheTableExtrapolatesAndApproachWhileTheyGrow) {
  NeighbourTable table(table_options());
  SilentRobots silent(options());
  table.take({RobotId(1), 1, at(0), {0, 2}, {0, -1}}, Vec2::Zero());
  silent.on_state(state(1, 0, {0, 2}));
  silent.update(at(1000), Whereabouts(clears()));

  const auto near = table.at(at(1000), Vec2::Zero(), &silent).all;

  ASSERT_EQ(near.size(), 1U) << "once";
  EXPECT_EQ(near[0].position_m, Vec2(0.0, 2.0)) << "the centre of its disc";
  EXPECT_NEAR(near[0].velocity_mps.y(), -1.5, 1e-9);
}

// The disc of robot 1, 1 s old, has a radius of 1.7 m: a body of 0.2 m touches it up to 1.9 m.
TEST(SilentRobots, AreOnNoSideOfARobotThatIsWithinTheirDisc) {
  NeighbourTable table(table_options());
  SilentRobots silent(options());
  silent.on_state(state(1, 0, {0, 0}));
  silent.update(at(1000), Whereabouts(clears()));

  for (const double x_m : {0.0, 0.5, 1.84}) {
    const Neighbourhood near = table.at(at(1000), {x_m, 0}, &silent);
    EXPECT_TRUE(near.is_within_silent) << x_m;
    EXPECT_TRUE(near.all.empty()) << x_m;
  }
  const Neighbourhood near = table.at(at(1000), {1.86, 0}, &silent);
  EXPECT_FALSE(near.is_within_silent) << "on the surface: it can outrun it";
  EXPECT_EQ(near.close.size(), 1U);
}

}  // namespace
}  // namespace swarm::agent
