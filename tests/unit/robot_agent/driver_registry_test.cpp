// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/robot/driver_registry.hpp"

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

constexpr SteadyTime kStart{std::chrono::seconds(100)};

DriverRegistry builtin() {
  DriverRegistry registry;
  register_builtin_drivers(registry);
  return registry;
}

TEST(DriverRegistry, MakesTheBuiltInBodies) {
  const DriverRegistry registry = builtin();
  Mission mission;
  for (const char* name : {"single_integrator", "double_integrator", "unicycle"}) {
    mission.robots.model = name;
    const DriverEntry* entry = registry.find(name);
    ASSERT_NE(entry, nullptr) << name;
    const auto driver = entry->make(
        {.mission = mission, .robot = RobotId(3), .position_m = {4, 5}, .now = kStart, .seed = 1});
    ASSERT_TRUE(driver) << name;
    const Measurement at = (*driver)->measure(kStart);
    EXPECT_EQ(at.position_m, Vec2(4, 5)) << name;
    EXPECT_TRUE(at.is_valid) << name;
  }
}

TEST(DriverRegistry, GivesEachRobotTheOptionsOfItsGroup) {
  Mission mission;
  mission.robots.count = 3;
  mission.robots.options.set("port", 7);
  mission.robots.groups.push_back({mission.robots, 1});
  mission.robots.groups[0].options.set("port", 9);
  const auto port = [&](std::uint32_t robot) {
    return DriverContext{.mission = mission, .robot = RobotId(robot), .now = kStart}
        .options()
        .number("port");
  };
  EXPECT_EQ(port(0), 9.0);
  EXPECT_EQ(port(1), 7.0);
}

TEST(Driver, StopsByAZeroCommandByDefault) {
  const DriverRegistry registry = builtin();
  const Mission mission;
  const auto driver = *registry.find("single_integrator")
                           ->make({.mission = mission, .robot = RobotId(0), .now = kStart});
  driver->command(kStart, {1, 0}, std::chrono::seconds(1));
  const SteadyTime later = kStart + std::chrono::milliseconds(500);
  EXPECT_NEAR(driver->measure(later).position_m.x(), 0.5, 1e-12);
  driver->stop(later, StopKind::kHold);
  EXPECT_NEAR(driver->measure(later + std::chrono::milliseconds(400)).position_m.x(), 0.5, 1e-12);
}

}  // namespace
}  // namespace swarm::agent
