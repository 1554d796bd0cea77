// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_monitor/audit/recorded_run.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::monitor {
namespace {

UtcTime at(double time_s) {
  return UtcTime(std::chrono::seconds(1'800'000'000)) + from_seconds(time_s);
}

robot_log::LinkStats counters(std::uint32_t sent, std::vector<std::uint32_t> refused,
                              std::vector<std::int64_t> ages_us) {
  robot_log::LinkStats stats{.states_sent = sent, .refused = std::move(refused)};
  for (const std::int64_t age : ages_us) stats.state_age.add(age);
  return stats;
}

TEST(TrackMaker, KeepsTheNewestCountersOfEachIncarnation) {
  TrackMaker maker(RobotId(3), at(0));
  maker.take(robot_log::Header{.robot = RobotId(0), .process_id = 70, .radius_m = 0.2});
  maker.take(counters(10, {1, 0, 2}, {100}));
  maker.take(counters(25, {1, 4, 2}, {100, 200}));  // since its start: 25, not 35
  maker.take(robot_log::Header{.robot = RobotId(0), .process_id = 71, .radius_m = 0.3});
  maker.take(counters(5, {2}, {300}));

  const Track track = maker.finish();

  EXPECT_EQ(track.robot, RobotId(3));
  EXPECT_EQ(track.states_sent, 30U);
  EXPECT_EQ(track.refused, 9U);
  EXPECT_EQ(track.state_age.count(), 3U);
  EXPECT_EQ(track.processes, (std::vector<std::uint32_t>{70, 71}));
  EXPECT_EQ(track.radius_m, 0.3) << "that of the last incarnation";
}

robot_log::Step driving(double time_s, const Vec2& position_m) {
  return {.stamp = at(time_s), .position_m = position_m, .velocity_mps = {1.0, -0.5}};
}

TEST(TrackMaker, HasTheBodyOfADeadProcessDriveOnUntilItsCommandRunsOut) {
  constexpr Duration kPeriod = std::chrono::milliseconds(100);
  TrackMaker maker(RobotId(0), at(0), kPeriod);
  maker.take(robot_log::Header{});
  maker.take(driving(5.0, {3, 4}));  // killed after this step,
  maker.take(robot_log::Header{});
  maker.take(driving(7.0, {3.2, 3.9}));  // and again after this one

  const Track track = maker.finish();

  ASSERT_EQ(track.points.size(), 4U);
  EXPECT_DOUBLE_EQ(track.points[1].time_s, 5.2);
  EXPECT_TRUE(track.points[1].position_m.isApprox(Vec2(3.2, 3.9)));
  EXPECT_DOUBLE_EQ(track.points[3].time_s, 7.2);
  EXPECT_TRUE(track.points[3].position_m.isApprox(Vec2(3.4, 3.8)));
}

TEST(TrackMaker, EndsTheTrackOfAProcessThatEndedByItselfAtItsLastStep) {
  TrackMaker maker(RobotId(0), at(0), std::chrono::milliseconds(100));
  maker.take(robot_log::Header{});
  maker.take(driving(5.0, {3, 4}));
  maker.take(robot_log::Note{.stamp = at(5.0), .code = "exit", .text = "graceful end"});

  EXPECT_EQ(maker.finish().points.size(), 1U);
}

TEST(TrackMaker, AddsUpCountersBeyond32Bits) {
  TrackMaker maker(RobotId(0), at(0));
  for (int i = 0; i < 3; ++i) {
    maker.take(robot_log::Header{});
    maker.take(counters(0xFFFF'FFFF, {0xFFFF'FFFF, 0xFFFF'FFFF}, {}));
  }

  const Track track = maker.finish();

  EXPECT_EQ(track.states_sent, 3ULL * 0xFFFF'FFFF);
  EXPECT_EQ(track.refused, 6ULL * 0xFFFF'FFFF);
}

TEST(TrackMaker, HasTimesThatAscendWhateverTheClockDid) {
  Rng rng(4);
  for (int round = 0; round < 50; ++round) {
    TrackMaker maker(RobotId(0), at(0));
    std::size_t back = 0;
    double latest_s = -1e9;
    for (int k = 0; k < 60; ++k) {
      // Whole tenths, so that some steps have equal stamps.
      const double time_s = 0.1 * std::floor(uniform(rng, -20.0, 60.0) + k);
      back += time_s <= latest_s ? 1 : 0;
      latest_s = std::max(latest_s, time_s);
      maker.take(robot_log::Step{.stamp = at(time_s)});
    }

    const Track track = maker.finish();

    EXPECT_EQ(track.damaged, back);
    EXPECT_EQ(track.points.size(), 60 - back);
    for (std::size_t k = 1; k < track.points.size(); ++k) {
      EXPECT_LT(track.points[k - 1].time_s, track.points[k].time_s);
    }
  }
}

TEST(TrackMaker, CountsAStepAsLateOnlyBeyondTwentyMilliseconds) {
  TrackMaker maker(RobotId(0), at(0));
  int k = 0;
  for (const std::int32_t lateness_us : {-500, 0, 20'000, 20'001, 1'000'000}) {
    maker.take(robot_log::Step{.stamp = at(++k), .lateness_us = lateness_us});
  }

  EXPECT_EQ(maker.finish().late_ticks, 2U);
}

TEST(TrackMaker, CountsTheTicksThatWereMissed) {
  TrackMaker maker(RobotId(0), at(0), std::chrono::milliseconds(100));
  int k = 0;
  for (const std::int32_t lateness_us : {0, 21'000, 8'000'000, 250'000, 100'000}) {
    maker.take(robot_log::Step{.stamp = at(++k), .lateness_us = lateness_us});
  }

  const Track track = maker.finish();

  EXPECT_EQ(track.missed_ticks, 80U + 2U + 1U);
  EXPECT_EQ(track.late_ticks, 1U + 80U + 3U + 1U);
}

TEST(TrackMaker, TakesAnExitOfTheLastIncarnationAlone) {
  TrackMaker maker(RobotId(0), at(0));
  maker.take(robot_log::Header{});
  maker.take(robot_log::Note{.code = "exit"});
  maker.take(robot_log::Header{});  // respawned, and killed
  maker.take(robot_log::Note{.code = "exit-later"});

  const Track track = maker.finish();

  EXPECT_FALSE(track.ended_gracefully);
  EXPECT_EQ(track.notes.size(), 2U);
}

TEST(TrackMaker, CopiesEveryFieldOfAStep) {
  const robot_log::Step step{.stamp = at(2.5),
                             .position_m = {1.5, -2.5},
                             .mode = static_cast<std::uint8_t>(RobotMode::kHolding),
                             .goal = 6,
                             .neighbours = 700,
                             .plan_version = 8,
                             .plan_time_s = 9.5F,
                             .reference_x_m = 10.5F,
                             .reference_y_m = 11.5F};
  TrackMaker maker(RobotId(0), at(0));
  maker.add(step);
  maker.add(robot_log::Estimate{.stamp = at(3.0), .neighbour = RobotId(9), .position_m = {7, 8}});

  const Track track = maker.finish();

  ASSERT_EQ(track.points.size(), 1U);
  const TrackPoint& point = track.points[0];
  EXPECT_EQ(point.time_s, 2.5);
  EXPECT_EQ(point.position_m, Vec2(1.5, -2.5));
  EXPECT_EQ(point.mode, RobotMode::kHolding);
  EXPECT_EQ(point.goal, 6);
  EXPECT_EQ(point.neighbours, 700);
  EXPECT_EQ(point.plan_version, 8U);
  EXPECT_EQ(point.plan_time_s, 9.5F);
  EXPECT_EQ(point.reference_m(), Vec2(10.5, 11.5));
  ASSERT_EQ(track.estimates.size(), 1U);
  EXPECT_EQ(track.estimates[0].time_s, 3.0);
  EXPECT_EQ(track.estimates[0].neighbour, RobotId(9));
  EXPECT_EQ(track.estimates[0].position_m, Vec2(7, 8));
}

TEST(TrackMaker, IsEmptyAfterItsTrackIsFinished) {
  TrackMaker maker(RobotId(5), at(0));
  maker.take(robot_log::Header{.robot = RobotId(0), .process_id = 70, .radius_m = 0.2});
  maker.take(robot_log::Step{.stamp = at(1), .lateness_us = 30'000});
  maker.take(robot_log::Step{.stamp = at(1)});
  maker.take(counters(10, {1}, {100}));
  maker.take(robot_log::Note{.code = "exit"});
  (void)maker.finish();

  const Track empty = maker.finish();

  EXPECT_TRUE(empty.points.empty() && empty.processes.empty() && empty.notes.empty());
  EXPECT_FALSE(empty.ended_gracefully);
  EXPECT_EQ(empty.radius_m, 0.0);
  EXPECT_EQ(empty.damaged + empty.late_ticks + empty.refused + empty.states_sent, 0U);
  EXPECT_EQ(empty.state_age.count(), 0U);
}

}  // namespace
}  // namespace swarm::monitor
