// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/density_course.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "swarm_monitor/audit/tracking/swarm_walk.hpp"
#include "tests/unit/swarm_monitor/audit/tracking/planned_run.hpp"

namespace swarm::monitor {
namespace {

/// Area of the disc in which robots are counted: radius 2 m.
constexpr double kDisc_m2 = 4.0 * std::numbers::pi;

/// n robots at one place until `until_s`, after which all but one are gone, far from each other
/// before `from_s`.
RecordedRun packed_run(std::uint32_t robots, double from_s, double until_s) {
  RecordedRun run;
  run.begin = UtcTime(std::chrono::seconds(1000));
  run.plans = {{1, PlannedRun{}.plan()}};
  run.clock = {{run.begin, 1, 0.0, 1.0}};
  for (std::uint32_t i = 0; i < robots; ++i) {
    Track track{.robot = RobotId(i), .ended_gracefully = i == 0};
    for (int k = 0; k <= 60; ++k) {
      const bool packed = k >= from_s && k <= until_s;
      track.points.push_back({.time_s = 1.0 * k,
                              .position_m = {packed ? 10.0 : 100.0 * (i + 1), 5.0},
                              .mode = RobotMode::kMoving});
      if (i > 0 && k >= until_s) break;
    }
    run.tracks.push_back(track);
  }
  return run;
}

std::vector<PlanMoment> moments_of(const RecordedRun& run, double begin_s, double end_s) {
  return PlanTimeline(run).moments(begin_s, end_s, 1.0);
}

TEST(DensityCourse, CountsTheFullestDiscAtEveryMoment) {
  const RecordedRun run = packed_run(6, 10.0, 20.0);

  const auto course = density_course(run, moments_of(run, 0.0, 30.0));

  ASSERT_TRUE(course);
  ASSERT_EQ(course->moments.size(), 31U);
  for (const DensityMoment& moment : course->moments) {
    const bool packed = moment.time_s >= 10.0 && moment.time_s <= 20.0;
    EXPECT_NEAR(moment.flown_per_m2, (packed ? 6.0 : 1.0) / kDisc_m2, 1e-12) << moment.time_s;
  }
  EXPECT_NEAR(course->worst_per_m2, 6.0 / kDisc_m2, 1e-12);
}

TEST(DensityCourse, ReportsTheLevelOfNineteenMomentsInTwenty) {
  // 40 moments, of which n are packed: with up to 2 of them 95 % are not.
  for (const int packed : {1, 2, 3}) {
    const RecordedRun run = packed_run(4, 10.0, 9.0 + packed);

    const auto course = density_course(run, moments_of(run, 0.0, 39.0));

    ASSERT_TRUE(course);
    EXPECT_NEAR(course->p95_per_m2, (packed <= 2 ? 1.0 : 4.0) / kDisc_m2, 1e-12) << packed;
  }
}

TEST(DensityCourse, MeasuresThePlanForAllRobotsAlsoWhenSomeHaveFallen) {
  const RecordedRun run = packed_run(50, 10.0, 20.0);

  const auto course = density_course(run, moments_of(run, 0.0, 60.0));

  // At second 30 one of 50 robots is alive, the plan holds 50 at rest or on its legs.
  ASSERT_TRUE(course);
  const double expected =
      planned_peak_density_per_m2(run.plans[0].plan.mixture_at(MissionTime(30.0)), 50);
  EXPECT_NEAR(course->moments[30].planned_per_m2, expected, 1e-12);
  EXPECT_NEAR(course->moments[30].flown_per_m2, 1.0 / kDisc_m2, 1e-12);
  EXPECT_GE(course->planned_worst_per_m2, expected);
}

TEST(DensityCourse, CountsMomentsAFifthOverTheCapAsDense) {
  RecordedRun run = packed_run(6, 10.0, 20.0);
  const auto share_with_cap = [&](double cap_per_m2) {
    run.mission.planner.density_cap_per_m2 = cap_per_m2;
    return density_course(run, moments_of(run, 0.0, 30.0))->dense_share;
  };

  // 11 of the 31 moments have 6 robots in a disc, the others 1.
  EXPECT_DOUBLE_EQ(share_with_cap(5.01 / kDisc_m2).value(), 0.0) << "6 is 19.8 % more";
  EXPECT_DOUBLE_EQ(share_with_cap(4.99 / kDisc_m2).value(), 11.0 / 31.0);
  EXPECT_DOUBLE_EQ(share_with_cap(0.8 / kDisc_m2).value(), 1.0);
}

TEST(DensityCourse, HasNoShareWithoutACap) {
  const RecordedRun run = packed_run(6, 10.0, 20.0);

  const auto course = density_course(run, moments_of(run, 0.0, 30.0));

  ASSERT_TRUE(course);
  EXPECT_FALSE(course->cap_per_m2 || course->dense_share || course->over_cap(1.0));
}

TEST(DensityCourse, IsEmptyWithoutMomentsOrRobots) {
  const RecordedRun run = packed_run(6, 10.0, 20.0);
  EXPECT_FALSE(density_course(run, {}));
  RecordedRun none = run;
  none.tracks.clear();
  EXPECT_FALSE(density_course(none, moments_of(none, 0.0, 30.0)));
}

TEST(DensityCourse, ComparesAPeakWithTheCap) {
  const DensityCourse course{.cap_per_m2 = 2.0};
  EXPECT_DOUBLE_EQ(course.over_cap(3.0).value(), 0.5);
  EXPECT_DOUBLE_EQ(course.over_cap(2.0).value(), 0.0);
  EXPECT_DOUBLE_EQ(course.over_cap(0.0).value(), -1.0);
}

TEST(DensityCapOf, IsTheMethodsOwnBeforeThatOfTheMission) {
  RecordedRun run;
  run.mission.planner.density_cap_per_m2 = 0.5;
  EXPECT_EQ(density_cap_of(run), 0.5);

  run.planning = PlanningRecord{};
  run.planning->density_cap_per_m2 = 0.8;
  EXPECT_EQ(density_cap_of(run), 0.8);

  // The method recorded that it held its plans to none, whatever the mission asked for.
  run.planning->density_cap_per_m2.reset();
  EXPECT_FALSE(density_cap_of(run));
}

TEST(DensityCapOf, OfZeroInTheMissionIsNone) {
  RecordedRun run;
  run.mission.planner.density_cap_per_m2 = 0.0;
  EXPECT_FALSE(density_cap_of(run));
  run.mission.planner.density_cap_per_m2.reset();
  EXPECT_FALSE(density_cap_of(run));
}

}  // namespace
}  // namespace swarm::monitor
