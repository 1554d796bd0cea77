// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/mission/body_limits.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "swarm_launcher/processes/builtin_catalogue.hpp"

namespace swarm {
namespace {

RobotsSpec robots_of(const char* model) {
  RobotsSpec robots;
  robots.model = model;
  robots.lag_s = declared_lag_s(robots, find_component(builtin_catalogue().drivers, model)->lag);
  return robots;
}

SwarmLimits limits_of(const RobotsSpec& robots) { return swarm_limits(robots, {}, {}); }

TEST(BodyLimits, PackRobotsAtTheDistanceTheFilterKeeps) {
  const SwarmLimits limits = limits_of(robots_of("single_integrator"));

  // A hexagonal lattice of 0.2 + 0.2 + 0.25 m has one point per √3/2 d².
  EXPECT_NEAR(limits.packing_per_m2, 1.0 / (0.5 * std::sqrt(3.0) * 0.65 * 0.65), 1e-12);
  EXPECT_NEAR(limits.packing_per_m2, 2.73, 0.01);
  EXPECT_NEAR(limits.cap_per_m2, 2.05, 0.01);
  EXPECT_NEAR(limits.plan_speed_mps, 0.9 * ControlSpec{}.cruise_mps, 1e-12);
  EXPECT_GT(limits.robot_speed_mps, limits.plan_speed_mps);
}

TEST(BodyLimits, AddUpTheLagThatABodyDeclares) {
  RobotsSpec robots;
  robots.speed_max_mps = 1.2;
  robots.acceleration_max_mps2 = 0.6;
  robots.turn_rate_max_radps = 2.0;
  EXPECT_EQ(declared_lag_s(robots, LagSpec{}), 0.0);
  EXPECT_NEAR(declared_lag_s(robots, LagSpec{.fixed_s = 0.1, .accelerates = true}), 2.1, 1e-12);
  EXPECT_NEAR(declared_lag_s(robots, LagSpec{.turns = true}), 0.25 * std::numbers::pi, 1e-12);
}

TEST(BodyLimits, GiveBodiesWithLagMoreRoomAndTime) {
  const SwarmLimits quick = limits_of(robots_of("single_integrator"));
  const SwarmLimits heavy = limits_of(robots_of("double_integrator"));
  const SwarmLimits wheels = limits_of(robots_of("unicycle"));

  // A unicycle, whose lag is twice the other's: densities and speeds that were flown.
  EXPECT_NEAR(wheels.cap_per_m2, 0.8, 0.05);
  EXPECT_NEAR(wheels.plan_speed_mps, 1.0, 0.05);
  EXPECT_GT(heavy.cap_per_m2, wheels.cap_per_m2);
  EXPECT_LT(heavy.cap_per_m2, quick.cap_per_m2);
  EXPECT_LT(heavy.plan_speed_mps, quick.plan_speed_mps);
}

TEST(BodyLimits, FollowTheMostRestrictiveBodyThatIsThere) {
  RobotsSpec robots;
  robots.count = 10;
  RobotGroupSpec large;
  large.radius_m = 0.5;
  large.count = 4;
  RobotGroupSpec slow;
  slow.speed_max_mps = 0.7;
  slow.count = 6;
  robots.groups = {large, slow};

  const SwarmLimits limits = limits_of(robots);
  RobotsSpec all_large;
  all_large.radius_m = 0.5;

  EXPECT_EQ(limits.packing_per_m2, limits_of(all_large).packing_per_m2);
  EXPECT_NEAR(limits.plan_speed_mps, 0.9 * 0.7, 1e-12);

  // The body of the robots that belong to no group counts only if there are some.
  robots.radius_m = 2.0;
  EXPECT_EQ(limits_of(robots).packing_per_m2, limits.packing_per_m2);
  robots.count = 11;
  EXPECT_LT(limits_of(robots).packing_per_m2, limits.packing_per_m2);
}

}  // namespace
}  // namespace swarm
