// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission/body_scale.hpp"

#include <gtest/gtest.h>

namespace swarm {
namespace {

BodySpec body(double radius_m, double speed_max_mps) {
  BodySpec made;
  made.radius_m = radius_m;
  made.speed_max_mps = speed_max_mps;
  return made;
}

// To the last bit: missions of such robots behave as they did without the factor.
TEST(LengthScale, IsOneForTheDefaultBody) {
  EXPECT_EQ(length_scale(BodySpec{}), 1.0);
  EXPECT_EQ(length_scale(RobotsSpec{}), 1.0);
}

TEST(LengthScale, IsTheFactorOfRadiusAndSpeedThatIsNearerToOne) {
  EXPECT_DOUBLE_EQ(length_scale(body(0.01, 0.075)), 0.05);
  EXPECT_DOUBLE_EQ(length_scale(body(4.0, 30.0)), 20.0);
  EXPECT_DOUBLE_EQ(length_scale(body(0.1, 0.3)), 0.5);
  EXPECT_DOUBLE_EQ(length_scale(body(0.4, 6.0)), 2.0);
}

TEST(LengthScale, IsOneForASmallFastBodyAndALargeSlowOne) {
  EXPECT_EQ(length_scale(body(0.05, 3.0)), 1.0);
  EXPECT_EQ(length_scale(body(0.5, 1.0)), 1.0);
}

TEST(LengthScale, OfAllRobotsIsThatOfTheLargest) {
  RobotsSpec robots;
  robots.radius_m = 0.02;
  robots.speed_max_mps = 0.15;
  robots.count = 10;
  EXPECT_DOUBLE_EQ(length_scale(robots), 0.1);
  RobotGroupSpec large;
  large.radius_m = 0.1;
  large.speed_max_mps = 0.75;
  large.count = 4;
  robots.groups = {large};
  EXPECT_DOUBLE_EQ(length_scale(robots), 0.5);
  large.radius_m = 0.01;
  large.speed_max_mps = 0.075;
  large.count = 10;
  robots.groups = {large};
  EXPECT_DOUBLE_EQ(length_scale(robots), 0.05) << "no robot has the body of all others";
}

}  // namespace
}  // namespace swarm
