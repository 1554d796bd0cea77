// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/supervision/fallen_body.hpp"

#include <gtest/gtest.h>

#include "robot_agent/drivers/simulated_robot.hpp"
#include "swarm_core/mission/scene_bodies.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::launcher {
namespace {

using std::chrono::milliseconds;

Mission mission_of(const std::string& model) {
  Mission mission;
  mission.robots.model = model;
  return mission;
}

UtcTime at_s(double s) { return UtcTime(from_seconds(100.0 + s)); }

// Drivers integrate in steps of 5 ms: during the last step before rest, at 3 m/s², they overshoot
// by this much.
constexpr double kStep_m = 2e-5;

bool covers(const Circle& circle, const Vec2& centre_m, double radius_m) {
  return (centre_m - circle.center_m).norm() + radius_m <= circle.radius_m + kStep_m;
}

// The driver is the oracle: wherever the body moves after the last command, it stays inside the
// circle, for any command before.
TEST(CircleOfFallen, CoversTheBodyFromTheLastTickToItsRest) {
  Rng rng(4);
  for (const std::string model : {"single_integrator", "double_integrator", "unicycle"}) {
    const Mission mission = mission_of(model);
    for (int i = 0; i < 300; ++i) {
      const SteadyTime begin{std::chrono::seconds(1)};
      agent::SimulatedRobot body = agent::make_simulated_body(mission.robots, begin, {5, 5}, rng());
      std::vector<robot_log::Step> log;
      SteadyTime now = begin;
      Vec2 command_mps = Vec2::Zero();
      for (int tick = 0; tick < 12; ++tick, now += milliseconds(100)) {
        if (tick == 0 || rng() % 4 == 0) {
          const double angle = uniform(rng, 0.0, 6.2831853);
          command_mps = uniform(rng, 0.0, 1.5) * Vec2(std::cos(angle), std::sin(angle));
          if (rng() % 4 == 0) command_mps = Vec2::Zero();
        }
        log.push_back({.stamp = at_s(0.1 * tick),
                       .position_m = body.measure(now).position_m,
                       .velocity_mps = command_mps});
        body.command(now, command_mps, milliseconds(200));
      }

      auto known = last_known(log, mission);
      ASSERT_TRUE(known.has_value());
      known->is_last = true;
      const Circle circle = circle_of_fallen(*known, at_s(1.2), mission, RobotId(0));

      for (int look = 0; look < 30; ++look, now += milliseconds(50)) {
        ASSERT_TRUE(covers(circle, body.measure(now).position_m, mission.robots.radius_m))
            << model << ", flight " << i << ", look " << look;
      }
    }
  }
}

TEST(CircleOfFallen, AfterTheLastStepDoesNotGrowWithTime) {
  const LastKnown known{.at = at_s(0.0),
                        .position_m = {3, 4},
                        .command_mps = Vec2(1, 0),
                        .speed_mps = 1.0,
                        .is_last = true};
  const Mission mission = mission_of("single_integrator");
  const auto radius_m = [&](double age_s) {
    return circle_of_fallen(known, at_s(age_s), mission, RobotId(0)).radius_m;
  };

  EXPECT_EQ(radius_m(5.0), radius_m(0.1));
  EXPECT_NEAR(radius_m(5.0), 0.2 + 0.1, 1e-9) << "half of two periods at 1 m/s";
}

TEST(CircleOfFallen, OfARobotThatMakesStepsCoversItsMotionUntilItHolds) {
  const Mission mission = mission_of("single_integrator");
  const LastKnown known{
      .at = at_s(0.0), .position_m = {3, 4}, .command_mps = Vec2(1, 0), .speed_mps = 1.0};

  for (const double age_s : {0.1, 5.0}) {
    const Circle circle = circle_of_fallen(known, at_s(age_s), mission, RobotId(0));
    EXPECT_EQ(circle.center_m, Vec2(3, 4));
    EXPECT_NEAR(circle.radius_m, 0.2 + 1.5 * (1.0 + mission.timing.planner_silence_s + 0.2), 1e-9);
  }
}

TEST(CircleOfFallen, IsTheBodyWhereARobotIsAtRest) {
  const Circle by_step = circle_of_fallen({.at = at_s(0.0),
                                           .position_m = {3, 4},
                                           .command_mps = Vec2(0, 0),
                                           .speed_mps = 0.0,
                                           .is_last = true},
                                          at_s(0.1), mission_of("single_integrator"), RobotId(0));
  const Circle by_status =
      circle_of_fallen({.at = at_s(0.0), .position_m = {3, 4}, .at_rest = true}, at_s(0.9),
                       mission_of("single_integrator"), RobotId(0));

  for (const Circle& circle : {by_step, by_status}) {
    EXPECT_EQ(circle.center_m, Vec2(3, 4));
    EXPECT_EQ(circle.radius_m, 0.2);
  }
}

TEST(CircleOfFallen, GrowsWithTheAgeOfAStatusAndNotForGood) {
  const Mission mission = mission_of("single_integrator");
  const LastKnown status{.at = at_s(0.0), .position_m = {3, 4}};
  const auto radius_m = [&](double age_s) {
    return circle_of_fallen(status, at_s(age_s), mission, RobotId(0)).radius_m;
  };

  EXPECT_NEAR(radius_m(0.5), 0.2 + 1.5 * (0.5 + 0.2), 1e-9);
  const double holds_s = mission.timing.planner_silence_s;
  EXPECT_NEAR(radius_m(30.0), 0.2 + 1.5 * (1.0 + holds_s + 0.2), 1e-9)
      << "a period of its statuses, and until a robot that is cut off holds";
  EXPECT_NEAR(radius_m(-3.0), 0.2 + 1.5 * 0.2, 1e-9) << "a clock that is ahead of ours";
}

// Robots take a wider circle for that of a robot which may have driven on.
TEST(CircleOfFallen, ShowsByItsSizeWhetherTheRobotMayHaveDrivenOn) {
  for (const std::string model : {"single_integrator", "double_integrator", "unicycle"}) {
    for (const double status_hz : {0.5, 1.0, 10.0}) {
      Mission mission = mission_of(model);
      mission.link.status_hz = status_hz;
      const double frozen_m = frozen_body_radius_m(mission, RobotId(0));
      const auto radius_m = [&](const LastKnown& known, double age_s) {
        return circle_of_fallen(known, at_s(age_s), mission, RobotId(0)).radius_m;
      };
      LastKnown known{.at = at_s(0.0), .position_m = {3, 4}, .command_mps = Vec2(1.5, 0.0)};
      for (const double age_s : {0.1, 3.0, 1000.0}) {
        known.is_last = true;
        EXPECT_LE(radius_m(known, age_s), frozen_m);
        known.is_last = false;
        EXPECT_GT(radius_m(known, age_s), frozen_m + 1.0);
      }
      known.command_mps.reset();
      EXPECT_GT(radius_m(known, 30.0), frozen_m + 1.0);
    }
  }
}

}  // namespace
}  // namespace swarm::launcher
