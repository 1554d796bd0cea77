// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/drivers/motion_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "robot_agent/drivers/double_integrator.hpp"
#include "robot_agent/drivers/simulated_robot.hpp"
#include "robot_agent/drivers/single_integrator.hpp"
#include "robot_agent/drivers/unicycle.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::agent {
namespace {

constexpr double kPi = std::numbers::pi;

/// A velocity of any direction, sometimes zero, sometimes faster than the body.
Vec2 command(Rng& rng) {
  if (rng() % 5 == 0) return Vec2::Zero();
  const double angle = uniform(rng, -kPi, kPi);
  return uniform(rng, 0, 2.5) * Vec2(std::cos(angle), std::sin(angle));
}

Vec2 turned(const Vec2& v, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

TEST(Limited, ShortensToTheTopSpeedAndKeepsTheDirection) {
  Rng rng(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec2 wanted = command(rng);

    const Vec2 v = limited(wanted, 1.5);

    EXPECT_NEAR(v.norm(), std::min(wanted.norm(), 1.5), 1e-12);
    EXPECT_NEAR(v.x() * wanted.y(), v.y() * wanted.x(), 1e-12);
    EXPECT_GE(v.dot(wanted), 0.0);
  }
  EXPECT_EQ(limited({0, 0}, 1.5), Vec2(0, 0));
  EXPECT_EQ(limited({1.5, 0}, 1.5), Vec2(1.5, 0));
}

// Noise moves a body, and a world has no preferred direction: both commute with the motion.
template <class Model>
void expect_moves_the_same_elsewhere(Model here, Model there, const Vec2& by_m, double angle_rad) {
  there.displace(by_m);
  Rng rng(2);
  for (int i = 0; i < 200; ++i) {
    const double time_s = uniform(rng, 0, 0.3);
    const Vec2 wanted = command(rng);
    here.advance(time_s, wanted);
    there.advance(time_s, turned(wanted, angle_rad));
    ASSERT_NEAR((turned(here.position_m(), angle_rad) + by_m - there.position_m()).norm(), 0, 1e-9);
    ASSERT_NEAR((turned(here.velocity_mps(), angle_rad) - there.velocity_mps()).norm(), 0, 1e-9);
  }
}

TEST(MotionModel, IsTheSameInEveryPlaceAndDirection) {
  for (const double angle_rad : {0.0, 0.5 * kPi, 1.0, -2.5, kPi}) {
    const Vec2 by_m(-31.5, 7.25);
    const Vec2 origin(0, 0);
    const Unicycle unicycle(origin, 0.3, {});
    expect_moves_the_same_elsewhere(SingleIntegrator(origin, 1.5), SingleIntegrator(origin, 1.5),
                                    by_m, angle_rad);
    expect_moves_the_same_elsewhere(DoubleIntegrator(origin, 1.5, 3.0),
                                    DoubleIntegrator(origin, 1.5, 3.0), by_m, angle_rad);
    expect_moves_the_same_elsewhere(unicycle, Unicycle(origin, 0.3 + angle_rad, {}), by_m,
                                    angle_rad);
  }
}

TEST(MotionModel, OfNoTimeMovesNothing) {
  SingleIntegrator single({1, 2}, 1.5);
  DoubleIntegrator twice({1, 2}, 1.5, 3.0);
  Unicycle unicycle({1, 2}, 0.5, {});
  for (MotionModel* model : std::vector<MotionModel*>{&single, &twice, &unicycle}) {
    model->advance(0.0, {1, 1});
    EXPECT_EQ(model->position_m(), Vec2(1, 2));
  }
  EXPECT_EQ(twice.velocity_mps(), Vec2(0, 0));
  EXPECT_EQ(unicycle.speed_mps(), 0.0);
}

// Second implementation: the equation of motion, integrated in steps of a tenth of a millisecond.
TEST(DoubleIntegrator, SolvesItsEquationOfMotion) {
  constexpr double kStep_s = 1e-4;
  Rng rng(3);
  DoubleIntegrator sut({0, 0}, 1.5, 3.0);
  Vec2 x(0, 0), v(0, 0);
  for (int i = 0; i < 50; ++i) {
    const Vec2 target = limited(command(rng), 1.5);
    const int steps = static_cast<int>(rng() % 6000);
    sut.advance(steps * kStep_s, target);
    for (int k = 0; k < steps; ++k) {
      const Vec2 off = target - v;
      const Vec2 after =
          off.norm() > 3.0 * kStep_s ? Vec2(v + 3.0 * kStep_s * off.normalized()) : target;
      x += 0.5 * kStep_s * (v + after);
      v = after;
    }
    ASSERT_NEAR((sut.velocity_mps() - v).norm(), 0.0, 1e-6);
    ASSERT_NEAR((sut.position_m() - x).norm(), 0.0, 1e-4);
  }
}

// The bound that the class states for a turn from rest: ‖u‖ e₀²/(6 ω_max), e₀ = 0.5 rad.
TEST(Unicycle, LeavesTheLineOfItsCommandByNoMoreThanItsBound) {
  Rng rng(4);
  for (int i = 0; i < 300; ++i) {
    const UnicycleLimits limits{.speed_max_mps = 1.5,
                                .acceleration_max_mps2 = uniform(rng, 0.5, 100),
                                .turn_rate_max_radps = uniform(rng, 0.5, 6)};
    Unicycle sut({0, 0}, uniform(rng, -kPi, kPi), limits);
    const double speed_mps = uniform(rng, 0.1, 1.5);
    const double bound_m = speed_mps * 0.25 / (6 * limits.turn_rate_max_radps);
    for (int k = 0; k < 200; ++k) {
      sut.advance(0.05, {speed_mps, 0});
      // 1 % for the steps of the integration.
      ASSERT_LE(std::abs(sut.position_m().y()), 1.01 * bound_m + 1e-6) << i;
      ASSERT_GE(sut.position_m().x(), -1e-9);  // it never drives backwards
    }
    EXPECT_NEAR(std::abs(sut.heading_rad()), 0.0, 1e-9);
  }
}

TEST(Unicycle, TurnsTheShorterDirection) {
  Rng rng(5);
  for (int i = 0; i < 200; ++i) {
    const double from_rad = uniform(rng, -kPi, kPi);
    const double to_rad = uniform(rng, -kPi, kPi);
    const double off_rad = std::remainder(to_rad - from_rad, 2 * kPi);
    Unicycle sut({0, 0}, from_rad, {.turn_rate_max_radps = 2.0});

    sut.advance(std::abs(off_rad) / 2.0 / 2.0, {std::cos(to_rad), std::sin(to_rad)});

    // Half of the time it needs: it is half round, in [−π, π].
    EXPECT_NEAR(std::remainder(sut.heading_rad() - from_rad - 0.5 * off_rad, 2 * kPi), 0.0, 1e-9);
    EXPECT_LE(std::abs(sut.heading_rad()), kPi + 1e-12);
  }
}

TEST(Unicycle, KeepsItsLimitsUnderAnyCommands) {
  const UnicycleLimits limits{};
  Unicycle sut({0, 0}, 0.0, limits);
  Rng rng(6);
  for (int i = 0; i < 5000; ++i) {
    const double time_s = uniform(rng, 0, 0.02);
    const Vec2 before_m = sut.position_m();
    const double speed_mps = sut.speed_mps();
    const double heading_rad = sut.heading_rad();

    sut.advance(time_s, command(rng));

    EXPECT_GE(sut.speed_mps(), 0.0);
    EXPECT_LE(sut.speed_mps(), limits.speed_max_mps + 1e-12);
    EXPECT_LE(std::abs(sut.speed_mps() - speed_mps), limits.acceleration_max_mps2 * time_s + 1e-12);
    EXPECT_LE(std::abs(std::remainder(sut.heading_rad() - heading_rad, 2 * kPi)),
              limits.turn_rate_max_radps * time_s + 1e-12);
    EXPECT_LE((sut.position_m() - before_m).norm(), limits.speed_max_mps * time_s + 1e-12);
  }
}

TEST(BodySeed, DiffersBetweenRobotsAndRuns) {
  std::vector<std::uint64_t> seeds;
  for (std::uint32_t robot = 0; robot < 100; ++robot) {
    for (std::uint64_t run = 0; run < 100; ++run) seeds.push_back(body_seed(RobotId(robot), run));
  }
  std::sort(seeds.begin(), seeds.end());

  EXPECT_EQ(std::adjacent_find(seeds.begin(), seeds.end()), seeds.end());
}

}  // namespace
}  // namespace swarm::agent
