// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/neighbours/whereabouts.hpp"

#include <chrono>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

SteadyTime at(double s) { return SteadyTime(from_seconds(100.0 + s)); }

class WhereaboutsTest : public testing::Test {
 protected:
  /// Beats every half second in [from, to].
  void beats(double from_s, double to_s, const std::vector<RobotId>& silent = {}) {
    for (double s = from_s; s <= to_s; s += 0.5) beat(s, silent);
  }
  void beat(double s, const std::vector<RobotId>& silent = {}) {
    ++beat_.sequence;
    link::set_silent(beat_, silent);
    sut_.on_beat(beat_, at(s), at(s));
  }
  bool is_well(double last_state_s, double now_s) const {
    return sut_.is_well(RobotId(3), at(last_state_s), at(now_s));
  }

  Whereabouts sut_{{.robots = 3000,
                    .run = 7,
                    .beat_timeout = milliseconds(1500),
                    .launcher_silence = seconds(3),
                    .clock_skew = seconds(10),
                    .healthy_after = seconds(6),
                    .alive_after = milliseconds(1500)}};
  link::LauncherBeat beat_{.run = 7};
};

TEST_F(WhereaboutsTest, KnowNothingWithoutTheLauncher) {
  EXPECT_FALSE(is_well(-1000, 0));
  EXPECT_FALSE(sut_.last_beat());
  EXPECT_FALSE(sut_.is_launcher_lost(at(1000))) << "it was never received";
}

TEST_F(WhereaboutsTest, RememberAGapForAWhile) {
  const auto had_gap = [&](double now_s) { return sut_.had_gap(seconds(60), at(now_s)); };
  EXPECT_FALSE(had_gap(0)) << "the launcher has not been received yet";
  beats(0, 10);
  EXPECT_FALSE(had_gap(10));
  EXPECT_FALSE(had_gap(11.5));
  EXPECT_TRUE(had_gap(11.6));
  beats(25, 85);
  EXPECT_TRUE(had_gap(85));
  beats(85.5, 86);
  EXPECT_FALSE(had_gap(86));
}

TEST_F(WhereaboutsTest, KnowTheCirclesOfBodies) {
  Scene scene = first_scene(0);
  const auto add = [&](std::optional<RobotId> owner, Obstacle shape) {
    scene.obstacles.push_back({.id = 0, .owner = owner, .shape = std::move(shape)});
  };
  add(RobotId(9), Circle{{0, 0}, 0.5});
  add(std::nullopt, Circle{{0, 0}, 3.0});
  add(RobotId(3), Circle{{5, 5}, 2.0});
  add(RobotId(5), Polygon::make({{0, 0}, {1, 0}, {0, 1}}).value());

  sut_.on_scene(scene);

  EXPECT_EQ(sut_.obstacle_radius_m(RobotId(3)), 2.0);
  EXPECT_EQ(sut_.obstacle_radius_m(RobotId(9)), 0.5);
  EXPECT_GT(sut_.obstacle_radius_m(RobotId(5)), 1e9) << "no circle: it shows nothing";
  EXPECT_FALSE(sut_.obstacle_radius_m(RobotId(4)));
  EXPECT_FALSE(sut_.is_obstacle(RobotId(4)));
}

TEST_F(WhereaboutsTest, ClearARobotThatAllBeatsForLongEnoughLeaveOut) {
  beats(0, 20);
  EXPECT_FALSE(is_well(14.5, 20));
  EXPECT_TRUE(is_well(14, 20));
  EXPECT_FALSE(is_well(14, 21.6)) << "the beats have stopped";
}

TEST_F(WhereaboutsTest, BeginAnewAfterAGapOrAListing) {
  beats(0, 10);
  beats(12, 17.5);
  EXPECT_FALSE(is_well(-1, 17.5)) << "no beat for 2 s";
  beat(18);
  EXPECT_TRUE(is_well(-1, 18));

  beat(18.5, {RobotId(2), RobotId(3)});
  beats(19, 24);
  EXPECT_FALSE(is_well(-1, 24)) << "listed at 18.5";
  beat(24.5);
  EXPECT_TRUE(is_well(-1, 24.5));
}

TEST_F(WhereaboutsTest, BeginAnewWhenABeatHasNoRoomForAllSilentRobots) {
  beats(0, 10);
  std::vector<RobotId> many;
  for (std::uint32_t i = 0; i <= link::LauncherBeat::kMaxRanges; ++i) many.emplace_back(5 + 2 * i);
  beat(10.5, many);
  EXPECT_FALSE(beat_.lists_all);
  EXPECT_FALSE(is_well(-1, 10.5));
}

// A forged number must not keep the launcher's beats out for the rest of the run.
TEST_F(WhereaboutsTest, TakeAnyNumberAfterAGap) {
  beats(0, 10);
  link::LauncherBeat forged = beat_;
  forged.sequence = ~std::uint64_t{0};
  ASSERT_TRUE(sut_.on_beat(forged, at(10.2), at(10.2)));

  beat(10.5);
  EXPECT_EQ(sut_.last_beat(), at(10.2));
  beats(11, 20);

  EXPECT_EQ(sut_.last_beat(), at(20));
  EXPECT_TRUE(is_well(-1, 20));
}

TEST_F(WhereaboutsTest, RefuseBeatsWhoseTimeIsFarFromNow) {
  beats(0, 10);
  ++beat_.sequence;
  EXPECT_FALSE(sut_.on_beat(beat_, at(10.5), at(21)));
  EXPECT_FALSE(sut_.on_beat(beat_, at(10.5), at(0)));
  EXPECT_TRUE(sut_.on_beat(beat_, at(10.5), at(1)));
}

TEST_F(WhereaboutsTest, RefuseBeatsOfOthersOldOnesAndUnknownIds) {
  beats(0, 10);
  link::LauncherBeat other = beat_;
  other.run = 8;
  other.sequence += 5;
  sut_.on_beat(other, at(10.5), at(10.5));
  sut_.on_beat(beat_, at(10.5), at(10.5));  // again
  link::LauncherBeat forged = beat_;
  ++forged.sequence;
  forged.ranges = 1;
  forged.range[0] = {.first = 2999, .count = 2};
  sut_.on_beat(forged, at(10.5), at(10.5));
  forged.range[0] = {.first = 2, .count = 0xFFFF'FFFF};
  sut_.on_beat(forged, at(10.5), at(10.5));

  EXPECT_EQ(sut_.last_beat(), at(10));
  EXPECT_EQ(sut_.refused(), 4U);
}

TEST_F(WhereaboutsTest, KnowARobotAliveByOneBeatThatDoesNotListItAsLate) {
  const auto is_alive = [&](double last_state_s, double now_s) {
    return sut_.is_alive(RobotId(3), at(last_state_s), at(now_s));
  };
  const link::LateRobot late{.robot = 3};
  EXPECT_TRUE(sut_.may_be_late(RobotId(3), at(0))) << "without a beat";
  beat(10);
  EXPECT_TRUE(is_alive(8.5, 10));
  EXPECT_FALSE(is_alive(8.6, 10)) << "it would not be listed yet";
  EXPECT_FALSE(is_alive(8.5, 11.6)) << "the beat is out of date";

  link::set_late(beat_, {&late, 1});
  beat(10.5);
  EXPECT_FALSE(is_alive(0, 10.5)) << "late";
  link::set_late(beat_, {});
  beat(11, {RobotId(3)});
  EXPECT_FALSE(is_alive(0, 11)) << "silent";
  beat(11.5);
  EXPECT_TRUE(is_alive(0, 11.5));
  beat_.lists_all_late = false;
  beat(12);
  EXPECT_FALSE(is_alive(0, 12)) << "not all late robots are listed";

  beat_.lists_all_late = true;
  beat_.lists_all = false;
  beat_.ranges = link::LauncherBeat::kMaxRanges;
  ++beat_.sequence;
  ASSERT_TRUE(sut_.on_beat(beat_, at(12.5), at(12.5)));
  EXPECT_TRUE(sut_.may_be_late(RobotId(3), at(12.5))) << "not all silent robots are listed";

  beat_.lists_all = true;
  beat_.ranges = 0;
  ++beat_.sequence;
  ASSERT_TRUE(sut_.on_beat(beat_, at(13), at(12.6)));
  EXPECT_TRUE(is_alive(11.1, 13));
  EXPECT_FALSE(is_alive(11.2, 13)) << "it was sent before it arrived";
}

TEST_F(WhereaboutsTest, RefuseLateRobotsThatTheMissionDoesNotHaveOrThatAreNowhere) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto take = [&](const link::LateRobot& late) {
    ++beat_.sequence;
    link::set_late(beat_, {&late, 1});
    return sut_.on_beat(beat_, at(1), at(1));
  };
  EXPECT_TRUE(take({.robot = 2999, .x_m = 1.0, .y_m = 2.0}));
  EXPECT_FALSE(take({.robot = 3000, .x_m = 1.0, .y_m = 2.0}));
  EXPECT_FALSE(take({.robot = 3, .x_m = kNan, .y_m = 2.0}));
  EXPECT_FALSE(take({.robot = 3, .x_m = 1.0, .y_m = std::numeric_limits<double>::infinity()}));
  EXPECT_EQ(sut_.refused(), 3U);
}

TEST_F(WhereaboutsTest, ReportALauncherWhoseBeatsHaveStopped) {
  beats(0, 10);
  EXPECT_FALSE(sut_.is_launcher_lost(at(13)));
  EXPECT_TRUE(sut_.is_launcher_lost(at(13.1)));
  beat(14);
  EXPECT_FALSE(sut_.is_launcher_lost(at(14)));
}

}  // namespace
}  // namespace swarm::agent
