// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/drivers/simulated_robot.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "robot_agent/drivers/double_integrator.hpp"
#include "robot_agent/drivers/single_integrator.hpp"
#include "robot_agent/drivers/unicycle.hpp"

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;
SteadyTime at(int ms) { return SteadyTime(milliseconds(ms)); }

TEST(SimulatedRobot, IsAlwaysWell) {
  const SimulatedRobot sut(at(0), {1, 1});
  const DriverHealth health = sut.health();
  EXPECT_EQ(health.level, DriverHealth::Level::kGood);
  EXPECT_TRUE(health.text.empty());
}

TEST(SimulatedRobot, MovesWithItsCommand) {
  SimulatedRobot sut(at(0), {1, 1});
  sut.command(at(0), {1, -2}, milliseconds(200));

  const Measurement m = sut.measure(at(100));

  EXPECT_NEAR(m.position_m.x(), 1.1, 1e-12);
  EXPECT_NEAR(m.position_m.y(), 0.8, 1e-12);
  EXPECT_EQ(m.true_position_m, m.position_m);
  EXPECT_FALSE(m.command_expired);
}

TEST(SimulatedRobot, StopsByItselfWhenTheCommandRunsOut) {
  SimulatedRobot sut(at(0), {0, 0});
  sut.command(at(0), {1, 0}, milliseconds(200));

  const Measurement late = sut.measure(at(1000));

  EXPECT_NEAR(late.position_m.x(), 0.2, 1e-12);
  EXPECT_TRUE(late.command_expired);
  EXPECT_EQ(late.expired_at, at(200));
  EXPECT_NEAR(late.expired_position_m.x(), 0.2, 1e-12);
  EXPECT_FALSE(sut.measure(at(1100)).command_expired);
}

TEST(SimulatedRobot, BrakesWhenTheCommandRunsOut) {
  for (const std::string model : {"unicycle", "double_integrator"}) {
    const BodySpec body{.model = model, .speed_max_mps = 1.5, .acceleration_max_mps2 = 3.0};
    SimulatedRobot sut = make_simulated_body(body, at(0), {0, 0}, 1);
    sut.command(at(0), {1.5, 0}, milliseconds(5000));
    sut.measure(at(4000));
    const Vec2 before = sut.measure(at(5000)).position_m;

    const Measurement late = sut.measure(at(7000));

    EXPECT_TRUE(late.command_expired);
    EXPECT_NEAR((late.expired_position_m - before).norm(), 0.0, 1e-9) << model;
    EXPECT_NEAR(late.position_m.x() - before.x(), 1.5 * 1.5 / (2 * 3.0), 0.01) << model;
    EXPECT_EQ(sut.measure(at(8000)).position_m, late.position_m) << model;
  }
}

// Over 20 000 steps the standard error of a variance is 1 %.
double variance(double sum, double sum_of_squares, int n) {
  return sum_of_squares / n - (sum / n) * (sum / n);
}

TEST(SimulatedRobot, AddsMotionNoiseToEveryStepUnderCommand) {
  SimulatedRobot sut(at(0), SingleIntegrator(Vec2(0, 0)), {.motion_m = 0.1}, 7);
  constexpr int kSteps = 20'000;
  double sum = 0.0;
  double squares = 0.0;
  double product = 0.0;
  Vec2 last(0, 0);
  for (int k = 1; k <= kSteps; ++k) {
    sut.command(at(100 * (k - 1)), {1, 0}, milliseconds(200));
    const Measurement m = sut.measure(at(100 * k));
    ASSERT_EQ(m.position_m, *m.true_position_m);
    const Vec2 w = m.position_m - last - Vec2(0.1, 0);
    last = m.position_m;
    sum += w.x();
    squares += w.x() * w.x();
    product += w.x() * w.y();
  }

  EXPECT_NEAR(sum / kSteps, 0.0, 0.003);
  EXPECT_NEAR(variance(sum, squares, kSteps), 0.01, 0.0004);
  EXPECT_NEAR(product / kSteps, 0.0, 0.0003);
  const Vec2 stopped = sut.measure(at(100 * kSteps + 1000)).position_m;
  EXPECT_EQ(sut.measure(at(100 * kSteps + 2000)).position_m, stopped);
}

TEST(SimulatedRobot, MeasuresWithNoiseAndReportsItsTruePosition) {
  SimulatedRobot sut(at(0), SingleIntegrator(Vec2(3, 4)), {.position_m = 0.2}, 7);
  constexpr int kSteps = 20'000;
  double sum = 0.0;
  double squares = 0.0;
  for (int k = 1; k <= kSteps; ++k) {
    const Measurement m = sut.measure(at(k));
    ASSERT_EQ(*m.true_position_m, Vec2(3, 4));
    const double n = m.position_m.x() - 3.0;
    sum += n;
    squares += n * n;
  }

  EXPECT_NEAR(sum / kSteps, 0.0, 0.006);
  EXPECT_NEAR(variance(sum, squares, kSteps), 0.04, 0.0016);
}

TEST(SimulatedRobot, RepeatsItselfForTheSameSeedOnly) {
  const BodySpec body{.model = "unicycle", .motion_noise_m = 0.01, .position_noise_m = 0.05};
  const auto end = [&](std::uint64_t seed) {
    SimulatedRobot robot = make_simulated_body(body, at(0), {0, 0}, seed);
    robot.command(at(0), {1, 0}, milliseconds(3000));
    robot.measure(at(1000));
    return robot.measure(at(2000)).position_m;
  };

  EXPECT_EQ(end(1), end(1));
  EXPECT_NE(end(1), end(2));
}

TEST(SingleIntegrator, IsNoFasterThanItCan) {
  SingleIntegrator sut({0, 0}, 1.5);

  sut.advance(1.0, {3, 4});

  EXPECT_NEAR(sut.position_m().norm(), 1.5, 1e-12);
}

TEST(DoubleIntegrator, ReachesItsVelocityWithinItsLimits) {
  DoubleIntegrator sut({0, 0}, 1.5, 3.0);
  Vec2 before = Vec2::Zero();
  for (int step = 0; step < 100; ++step) {
    const Vec2 wanted = step < 50 ? Vec2(2, 0) : Vec2(0, -1);
    sut.advance(0.02, wanted);
    EXPECT_LE((sut.velocity_mps() - before).norm(), 3.0 * 0.02 + 1e-12);
    EXPECT_LE(sut.velocity_mps().norm(), 1.5 + 1e-12);
    before = sut.velocity_mps();
    if (step == 49) {
      EXPECT_NEAR(before.x(), 1.5, 1e-12);
    }
  }

  EXPECT_NEAR((before - Vec2(0, -1)).norm(), 0.0, 1e-12);
}

TEST(DoubleIntegrator, IsExactForAnyStep) {
  DoubleIntegrator fine({0, 0}, 1.5, 3.0);
  DoubleIntegrator coarse({0, 0}, 1.5, 3.0);

  for (int step = 0; step < 1000; ++step) fine.advance(0.001, {1, 1});
  coarse.advance(1.0, {1, 1});

  EXPECT_NEAR((fine.position_m() - coarse.position_m()).norm(), 0.0, 1e-9);
  // ½ a t² until v = √2, then on.
  const double t = std::sqrt(2.0) / 3.0;
  EXPECT_NEAR(coarse.position_m().norm(), 1.5 * t * t + (1.0 - t) * std::sqrt(2.0), 1e-12);
}

TEST(Unicycle, TurnsToItsVelocityWithinItsLimits) {
  Unicycle sut({0, 0}, 0.0,
               {.speed_max_mps = 1.5, .acceleration_max_mps2 = 3.0, .turn_rate_max_radps = 2.0});
  double speed_mps = 0.0;
  double heading_rad = 0.0;
  for (int step = 0; step < 200; ++step) {
    sut.advance(0.02, {0.0, 1.2});
    EXPECT_LE(std::abs(sut.speed_mps() - speed_mps), 3.0 * 0.02 + 1e-9);
    EXPECT_LE(std::abs(sut.heading_rad() - heading_rad), 2.0 * 0.02 + 1e-9);
    EXPECT_GE(sut.speed_mps(), 0.0);
    speed_mps = sut.speed_mps();
    heading_rad = sut.heading_rad();
  }

  EXPECT_NEAR((sut.velocity_mps() - Vec2(0, 1.2)).norm(), 0.0, 1e-9);
}

TEST(Unicycle, TurnsOnTheSpotForWhatIsBehindIt) {
  Unicycle sut({0, 0}, 0.0, {});

  sut.advance(0.5 * std::numbers::pi / 3.0, {-1.0, 0.0});  // a quarter turn
  EXPECT_LT(sut.position_m().norm(), 0.01);
  sut.advance(2.0, {-1.0, 0.0});

  EXPECT_NEAR((sut.velocity_mps() - Vec2(-1, 0)).norm(), 0.0, 1e-9);
}

TEST(Unicycle, KeepsItsHeadingWhenCommandedToStop) {
  Unicycle sut({0, 0}, 1.0, {});

  sut.advance(1.0, {0, 0});

  EXPECT_EQ(sut.position_m(), Vec2(0, 0));
  EXPECT_EQ(sut.heading_rad(), 1.0);
}

}  // namespace
}  // namespace swarm::agent
