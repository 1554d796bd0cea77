// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/robot/schedule.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::agent {
namespace {

//  l* [m]
//  20 |                  ______
//  10 |     ____________/
//   0 |____/
//     0   2    10   20  26      τ [s]      waits from 10 to 20 s
Schedule waits_in_the_middle() { return Schedule({{2, 0}, {10, 10}, {20, 10}, {26, 20}}); }

TEST(Schedule, IsLinearBetweenItsEntriesAndConstantOutside) {
  const Schedule sut = waits_in_the_middle();

  EXPECT_DOUBLE_EQ(sut.at_m(-5), 0);
  EXPECT_DOUBLE_EQ(sut.at_m(6), 5);
  EXPECT_DOUBLE_EQ(sut.at_m(15), 10);
  EXPECT_DOUBLE_EQ(sut.at_m(23), 15);
  EXPECT_DOUBLE_EQ(sut.at_m(100), 20);
  EXPECT_DOUBLE_EQ(sut.at_m(6), 5);  // also back in time
}

TEST(Schedule, MeanSpeedLeavesWaitsOut) {
  EXPECT_DOUBLE_EQ(waits_in_the_middle().mean_speed_mps(), 20.0 / 14.0);
  EXPECT_DOUBLE_EQ(Schedule({{3, 7}}).mean_speed_mps(), 1.0);
}

TEST(Schedule, LagIsSigned) {
  const Schedule sut = waits_in_the_middle();

  EXPECT_DOUBLE_EQ(sut.lag_s(8, 5), 2);  // at 5 m it was to be at 6 s
  EXPECT_DOUBLE_EQ(sut.lag_s(5, 5), -1);
  EXPECT_DOUBLE_EQ(sut.lag_s(23, 15), 0);
}

TEST(Schedule, WaitingIsNoLag) {
  const Schedule sut = waits_in_the_middle();

  EXPECT_DOUBLE_EQ(sut.lag_s(10, 10), 0);
  EXPECT_DOUBLE_EQ(sut.lag_s(17, 10), 0);
  EXPECT_DOUBLE_EQ(sut.lag_s(9, 10), -1);
  EXPECT_DOUBLE_EQ(sut.lag_s(22, 10), 2);
  EXPECT_DOUBLE_EQ(sut.lag_s(0, 0), 0);    // before the start
  EXPECT_DOUBLE_EQ(sut.lag_s(40, 20), 0);  // at the end
  EXPECT_DOUBLE_EQ(sut.lag_s(24, 20), -2);
}

TEST(Schedule, CountsWhatIsMissingBeforeItsFirstPoint) {
  const Schedule sut({{0, 4}, {10, 14}});  // the robot starts 4 m away from the plan: 1 m/s

  EXPECT_DOUBLE_EQ(sut.lag_s(0, 0), 4);
  EXPECT_DOUBLE_EQ(sut.lag_s(3, 1), 6);
}

/// Oracle: the definition, by search over a fine grid of times.
TEST(Schedule, LagIsTheDistanceToTheNearestTimeAtThatPoint) {
  Rng rng(7);
  for (int round = 0; round < 200; ++round) {
    std::vector<Schedule::Entry> entries{{0, 0}};
    for (int i = 0; i < 6; ++i) {
      const double step_s = 1.0 + 4.0 * uniform01(rng);
      const double step_m = uniform01(rng) < 0.3 ? 0.0 : 1.0 + 3.0 * uniform01(rng);
      entries.push_back({entries.back().time_s + step_s, entries.back().at_m + step_m});
    }
    const Schedule sut(entries);
    const double end_s = entries.back().time_s;
    const double tau = end_s * uniform01(rng);
    const double at_m = sut.at_m(end_s * uniform01(rng));
    double nearest = 1e9;
    for (double t = 0; t <= end_s; t += 1e-3) {
      if (std::abs(sut.at_m(t) - at_m) < 4e-3 && std::abs(tau - t) < std::abs(nearest)) {
        nearest = tau - t;
      }
    }
    // Before its first entry and after its last one the schedule is constant.
    if (at_m >= entries.back().at_m - 1e-9) nearest = std::min(nearest, 0.0);
    EXPECT_NEAR(sut.lag_s(tau, at_m), nearest, 0.02) << "round " << round;
  }
}

}  // namespace
}  // namespace swarm::agent
