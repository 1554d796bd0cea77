// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "robot_agent/drivers/simulated_robot.hpp"
#include "robot_agent/safety/safety_filter.hpp"
#include "swarmflow/mission/body_limits.hpp"
#include "swarmflow/robot/driver_registry.hpp"

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;

BodySpec body(const std::string& model) {
  BodySpec b;
  b.model = model;
  DriverRegistry drivers;
  register_builtin_drivers(drivers);
  b.lag_s = declared_lag_s(b, drivers.find(model)->spec.lag);
  return b;
}

/// Robots that all head for positions of others, with bodies that have a lag and a filter set to
/// it. Returns the least surface gaps of the run: between two robots, and to an obstacle.
std::pair<double, double> fly(const BodySpec& spec, const World& world, std::vector<Vec2> positions,
                              const std::vector<Vec2>& goals) {
  const SafetyOptions options{.radius_m = spec.radius_m,
                              .speed_max_mps = spec.speed_max_mps,
                              .period = milliseconds(100),
                              .lag_s = body_lag_s(spec)};
  const std::size_t n = positions.size();
  SafetyFilter filter(world, options);
  SteadyTime now{};
  std::vector<SimulatedRobot> bodies;
  for (std::size_t i = 0; i < n; ++i) {
    bodies.push_back(make_simulated_body(spec, now, positions[i], i));
  }
  std::vector<Vec2> velocities(n, Vec2::Zero());
  double gap_m = 1e9;
  double obstacle_m = 1e9;
  for (int step = 0; step < 600; ++step, now += milliseconds(100)) {
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<Neighbour> neighbours;
      for (std::size_t j = 0; j < n; ++j) {
        if (j == i) continue;
        neighbours.push_back(
            {RobotId(static_cast<std::uint32_t>(j)), positions[j], velocities[j], spec.radius_m});
      }
      const Vec2 desired_velocity = 1.5 * (goals[i] - positions[i]).normalized();
      bodies[i].command(now, filter.filter(positions[i], desired_velocity, neighbours),
                        milliseconds(200));
    }
    for (std::size_t i = 0; i < n; ++i) {
      const Measurement m = bodies[i].measure(now + milliseconds(100));
      positions[i] = m.position_m;
      velocities[i] = m.velocity_mps.value();
    }
    for (std::size_t i = 0; i < n; ++i) {
      obstacle_m = std::min(obstacle_m, world.distance_m(positions[i]) - spec.radius_m);
      for (std::size_t j = i + 1; j < n; ++j) {
        gap_m = std::min(gap_m, (positions[i] - positions[j]).norm() - 2.0 * spec.radius_m);
      }
    }
  }
  return {gap_m, obstacle_m};
}

TEST(LaggingBodies, DoNotMeetWhenTheySwapPositions) {
  const World world =
      *World::make({{-20, -20}, {20, 20}}, {*Polygon::make({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})});
  std::vector<Vec2> starts;
  std::vector<Vec2> goals;
  for (int i = 0; i < 12; ++i) {
    const Vec2 at(8.0 * std::cos(0.5236 * i), 8.0 * std::sin(0.5236 * i));
    starts.push_back(at);
    goals.emplace_back(-at);
  }
  for (const std::string model : {"double_integrator", "unicycle"}) {
    const auto [gap_m, obstacle_m] = fly(body(model), world, starts, goals);

    // A turning unicycle leaves its line by centimetres; bodies with inertia only keep the margins.
    const double leaves_m = model == "unicycle" ? 0.04 : 1e-6;
    EXPECT_GT(gap_m, 0.25 - leaves_m) << model;
    EXPECT_GT(obstacle_m, 0.05 - leaves_m) << model;
  }
}

TEST(LaggingBodies, StopBeforeAWallAtFullSpeed) {
  const World world =
      *World::make({{-20, -20}, {20, 20}}, {*Polygon::make({{9, -9}, {10, -9}, {10, 9}, {9, 9}})});
  for (const std::string model : {"double_integrator", "unicycle"}) {
    const auto [gap_m, obstacle_m] = fly(body(model), world, {{0, 0}}, {{20, 0}});

    EXPECT_GT(obstacle_m, 0.05 - 1e-6) << model;
    EXPECT_LT(obstacle_m, 0.06) << model;  // and go as far as they may
  }
}

TEST(LaggingBodies, TakeAsLongAsTheirLimitsDemand) {
  EXPECT_EQ(body_lag_s(body("single_integrator")), 0.0);
  EXPECT_DOUBLE_EQ(body_lag_s(body("double_integrator")), 1.5 / 3.0);
  EXPECT_NEAR(body_lag_s(body("unicycle")), 0.5 + 1.5708 / 3.0, 1e-4);
}

}  // namespace
}  // namespace swarm::agent
