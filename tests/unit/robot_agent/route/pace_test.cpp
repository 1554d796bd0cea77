// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/route/pace.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::agent {
namespace {

constexpr double kDt_s = 0.1;
const PaceOptions kOptions{
    .look_ahead_s = 6.0, .gain_hz = 0.3, .approach_gain_hz = 0.8, .cruise_mps = 1.45};

//  l* [m]  20 |              ___
//             |           _/
//          10 |    ______/           1 m/s, a wait from 10 to 20 s, 1 m/s
//           0 |___/
//             0   10     20   30     τ [s]
Pace waits_in_the_middle() { return {Schedule({{0, 0}, {10, 10}, {20, 10}, {30, 20}}), 20.0}; }

/// Speed at plan time τ of a robot at the arc length s that aims `ahead_m` ahead, not past the
/// carrot.
double speed_mps(const Pace& pace, const PlanTime& t, double s_m, double ahead_m) {
  const Pace::Now now = pace.at(t, kOptions);
  const double to_carrot_m = now.carrot_m - s_m;
  const double distance_m = std::min(ahead_m, to_carrot_m);
  return Pace::speed(now, to_carrot_m - distance_m, kOptions).at(distance_m);
}

TEST(Pace, LooksAheadInPlanTime) {
  const Pace sut = waits_in_the_middle();

  const Pace::Now full = sut.at({.plan_time_s = 2.0, .rate = 1.0}, kOptions);
  const Pace::Now half = sut.at({.plan_time_s = 2.0, .rate = 0.5}, kOptions);
  const Pace::Now paused = sut.at({.plan_time_s = 2.0, .rate = 0.0}, kOptions);

  EXPECT_DOUBLE_EQ(full.reference_m, 2.0);
  EXPECT_DOUBLE_EQ(full.carrot_m, 8.0);
  EXPECT_DOUBLE_EQ(full.feed_mps, 1.0);
  EXPECT_DOUBLE_EQ(half.carrot_m, 5.0);
  EXPECT_DOUBLE_EQ(half.feed_mps, 0.5);
  EXPECT_DOUBLE_EQ(paused.carrot_m, 2.0);
  EXPECT_DOUBLE_EQ(paused.feed_mps, 0.0);
  EXPECT_FALSE(full.is_last);
  EXPECT_TRUE(sut.at({.plan_time_s = 24.0, .rate = 1.0}, kOptions).is_last);
}

// The mean over the next second: no jerk at the end of a wait.
TEST(Pace, RaisesItsSpeedGraduallyWhenAWaitEnds) {
  const Pace sut = waits_in_the_middle();

  for (const auto& [tau, feed] : {std::pair{18.9, 0.0}, {19.25, 0.25}, {19.5, 0.5}, {20.0, 1.0}}) {
    EXPECT_NEAR(sut.at({.plan_time_s = tau, .rate = 1.0}, kOptions).feed_mps, feed, 1e-12) << tau;
  }
}

// v = l*′ τ̇ + k e makes e′ = −k e: in steps of dt the error falls by the factor 1 − k dt.
TEST(Pace, LetsTheDistanceToTheReferenceDecayExponentially) {
  const Pace sut(Schedule({{0, 0}, {1000, 1000}}), 1000.0);
  for (const double rate : {1.0, 0.6}) {
    for (const double late_m : {-1.0, 0.8}) {
      double s_m = 100.0 - late_m;
      double tau_s = 100.0;
      double expected_m = late_m;
      for (int k = 0; k < 100; ++k) {
        s_m += kDt_s * speed_mps(sut, {.plan_time_s = tau_s, .rate = rate}, s_m, 3.0);
        tau_s += rate * kDt_s;
        expected_m *= 1.0 - kOptions.gain_hz * kDt_s;
        ASSERT_NEAR(tau_s - s_m, expected_m, 1e-9) << rate << ' ' << late_m;
      }
    }
  }
}

// What counts is the distance to the carrot along the path; where the aim lies on it does not.
TEST(Pace, IsTheSameForEveryAimBeforeTheCarrot) {
  const Pace sut = waits_in_the_middle();
  Rng rng(2);
  for (int round = 0; round < 500; ++round) {
    const PlanTime t{.plan_time_s = uniform(rng, 0, 35), .rate = uniform01(rng)};
    const double s_m = uniform(rng, 0, sut.at(t, kOptions).carrot_m);
    const double near = speed_mps(sut, t, s_m, 0.0);

    EXPECT_NEAR(speed_mps(sut, t, s_m, uniform(rng, 0, 20)), near, 1e-9);
    EXPECT_NEAR(speed_mps(sut, t, s_m, 1e9), near, 1e-9);
  }
}

TEST(Pace, IsNeitherBackwardsNorFasterThanCruise) {
  const Pace sut = waits_in_the_middle();
  Rng rng(3);
  for (int round = 0; round < 1000; ++round) {
    const PlanTime t{.plan_time_s = uniform(rng, -5, 40), .rate = uniform01(rng)};

    const double v =
        Pace::speed(sut.at(t, kOptions), uniform(rng, 0, 20), kOptions).at(uniform(rng, 0, 20));

    EXPECT_GE(v, 0.0);
    EXPECT_LE(v, kOptions.cruise_mps);
  }
}

TEST(Pace, StopsWithThePlanAndAtTheEnd) {
  const Pace sut = waits_in_the_middle();

  // At its reference in a wait, in a pause, and at the end of the path.
  EXPECT_NEAR(speed_mps(sut, {.plan_time_s = 12.0, .rate = 1.0}, 10.0, 1.0), 0.0, 1e-12);
  EXPECT_NEAR(speed_mps(sut, {.plan_time_s = 5.0, .rate = 0.0}, 5.0, 1.0), 0.0, 1e-12);
  EXPECT_NEAR(speed_mps(sut, {.plan_time_s = 40.0, .rate = 1.0}, 20.0, 1.0), 0.0, 1e-12);
  // Late, it goes on.
  EXPECT_GT(speed_mps(sut, {.plan_time_s = 12.0, .rate = 1.0}, 9.0, 1.0), 0.0);
}

// When the reference has reached the end, what is left is driven as without a clock.
TEST(Pace, ApproachesTheEndAsWithoutAClock) {
  const Pace sut = waits_in_the_middle();
  for (const double left_m : {0.1, 0.5, 1.0, 1.9, 5.0}) {
    const AttractionSpeed free = free_speed(0.0, kOptions.approach_gain_hz, kOptions.cruise_mps);

    EXPECT_NEAR(speed_mps(sut, {.plan_time_s = 31.0, .rate = 1.0}, 20.0 - left_m, 99.0),
                free.at(left_m), 1e-12);
  }
}

TEST(Pace, MeasuresTheLagInPlanTime) {
  const Pace sut = waits_in_the_middle();

  EXPECT_DOUBLE_EQ(sut.lag_s({.plan_time_s = 8.0, .rate = 0.5}, 5.0), 3.0);
  EXPECT_DOUBLE_EQ(sut.lag_s({.plan_time_s = 8.0, .rate = 1.0}, 9.0), -1.0);
  EXPECT_DOUBLE_EQ(sut.lag_s({.plan_time_s = 15.0, .rate = 1.0}, 10.0), 0.0);
}

}  // namespace
}  // namespace swarm::agent
