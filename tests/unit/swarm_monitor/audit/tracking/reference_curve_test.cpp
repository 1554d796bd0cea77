// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/reference_curve.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::monitor {
namespace {

/// 1.25 m/s along x, with a wait from 30 to 50 s; 100 s in all.
Vec2 waiting_at(double tau) {
  const double moved_s = tau <= 30.0 ? tau : std::max(30.0, tau - 20.0);
  return {1.25 * moved_s, 7.0};
}

ReferenceCurve curve_of(Vec2 (*at)(double), double from_s, double to_s) {
  ReferenceCurve curve;
  for (double tau = from_s; tau <= to_s + 1e-9; tau += 0.1) curve.add(tau, at(tau));
  return curve;
}

TEST(ReferenceCurve, IsStraightBetweenWhatWasLogged) {
  const ReferenceCurve curve = curve_of(waiting_at, 0.0, 100.0);

  for (const double tau : {0.0, 0.13, 12.37, 41.0, 77.77, 100.0}) {
    EXPECT_NEAR((curve.at(tau) - waiting_at(tau)).norm(), 0.0, 1e-6) << tau;
  }
  // A corner in the middle of two entries 0.2 s apart is cut by half of 0.1 s at 1.25 m/s.
  EXPECT_NEAR((curve.at(30.0) - waiting_at(30.0)).norm(), 0.0, 0.0625 + 1e-6);
}

TEST(ReferenceCurve, ReportsHowLateAndHowEarlyARobotIs) {
  const ReferenceCurve curve = curve_of(waiting_at, 0.0, 100.0);

  EXPECT_NEAR(curve.lag_s(waiting_at(20.0), 20.0), 0.0, 1e-6);
  EXPECT_NEAR(curve.lag_s(waiting_at(14.0), 20.0), 6.0, 1e-6);
  EXPECT_NEAR(curve.lag_s(waiting_at(26.0), 20.0), -6.0, 1e-6);
  // A position beside the path has the same lag.
  EXPECT_NEAR(curve.lag_s(waiting_at(14.0) + Vec2(0.0, 3.0), 20.0), 6.0, 1e-6);
}

TEST(ReferenceCurve, CountsAWaitAsOneInterval) {
  const ReferenceCurve curve = curve_of(waiting_at, 0.0, 100.0);
  const Vec2 place = waiting_at(40.0);

  for (const double tau : {30.5, 40.0, 49.5}) EXPECT_EQ(curve.lag_s(place, tau), 0.0) << tau;
  EXPECT_NEAR(curve.lag_s(place, 55.0), 5.0, 0.25) << "from the end of the wait";
  EXPECT_NEAR(curve.lag_s(place, 20.0), -10.0, 0.25) << "to its begin";
  // A little behind a waiting reference is in time; the path of a whole second behind is not.
  EXPECT_EQ(curve.lag_s(place - Vec2(0.6, 0.0), 40.0), 0.0);
  EXPECT_GT(curve.lag_s(place - Vec2(1.25, 0.0), 40.0), 10.0);
}

TEST(ReferenceCurve, GoesOnBeyondItsEndsForAWhile) {
  const ReferenceCurve curve = curve_of(waiting_at, 5.0, 9.0);  // a plan in force for four seconds

  EXPECT_NEAR(curve.lag_s(waiting_at(2.0), 6.0), 4.0, 1e-3);
  EXPECT_NEAR(curve.lag_s(waiting_at(12.0), 6.0), -6.0, 1e-3);
  EXPECT_NEAR(curve.lag_s(waiting_at(28.0), 6.0), -13.0, 1e-3) << "ten seconds beyond the end";
}

TEST(ReferenceCurve, OfAReferenceThatComesBackTheNearerPassageCounts) {
  // To x = 25 and back, through the same points.
  const auto there_and_back = [](double tau) -> Vec2 {
    return {tau <= 20.0 ? 1.25 * tau : 50.0 - 1.25 * tau, 0.0};
  };
  ReferenceCurve curve;
  for (double tau = 0.0; tau <= 40.0; tau += 0.1) curve.add(tau, there_and_back(tau));

  EXPECT_NEAR(curve.lag_s(there_and_back(10.0), 12.0), 2.0, 1e-2);
  EXPECT_NEAR(curve.lag_s(there_and_back(30.0), 32.0), 2.0, 1e-2);
}

TEST(ReferenceCurve, LooksNoFartherThanItsWindow) {
  const auto slow = [](double tau) -> Vec2 { return {0.5 * tau, 0.0}; };
  ReferenceCurve curve;
  for (double tau = 0.0; tau <= 300.0; tau += 0.5) curve.add(tau, slow(tau));

  EXPECT_NEAR(curve.lag_s(slow(50.0), 200.0), ReferenceCurve::kWindow_s, 1e-6);
  EXPECT_NEAR(curve.lag_s(slow(290.0), 200.0), -ReferenceCurve::kWindow_s, 1e-6);
}

TEST(ReferenceCurve, EqualsFineSampling) {
  Rng rng(8);
  for (int round = 0; round < 20; ++round) {
    const double a = uniform(rng, 0.02, 0.06), b = uniform(rng, 2.0, 8.0);
    const auto at = [&](double tau) -> Vec2 { return {1.2 * tau, b * std::sin(a * tau)}; };
    ReferenceCurve curve;
    for (double tau = 0.0; tau <= 120.0; tau += 0.25) curve.add(tau, at(tau));
    const double tau = uniform(rng, 40.0, 80.0);
    const Vec2 p = at(tau - uniform(rng, -15.0, 15.0)) +
                   Vec2(uniform(rng, -2.0, 2.0), uniform(rng, -2.0, 2.0));
    double nearest_m = 1e300, expected_s = 0.0;
    for (double t = tau - 60.0; t <= tau + 60.0; t += 0.001) {
      if (t < 0.0 || t > 120.0 || (p - at(t)).norm() >= nearest_m) continue;
      nearest_m = (p - at(t)).norm();
      expected_s = tau - t;
    }

    EXPECT_NEAR(curve.lag_s(p, tau), expected_s, 0.02);  // chords of 0.25 s
  }
}

}  // namespace
}  // namespace swarm::monitor
