// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_drivers/ros/ros_robot.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "robot_drivers/ros/stamp_clock.hpp"

namespace swarm::drivers {
namespace {

constexpr double kPi = std::numbers::pi;

ros::Pose pose_at(double x, double y, double yaw) {
  return {.position = {.x = x, .y = y, .z = 0.3},
          .orientation = {.x = 0, .y = 0, .z = std::sin(yaw / 2), .w = std::cos(yaw / 2)}};
}

/// The robot's odometry began at (10, 5) of the world, facing north.
RosFrames turned() {
  RosOptions options;
  options.origin_x_m = 10;
  options.origin_y_m = 5;
  options.origin_yaw_rad = kPi / 2;
  return RosFrames(options);
}

TEST(RosFrames, TurnAPoseIntoTheWorld) {
  const auto pose = turned().pose(ros::PoseStamped{.pose = pose_at(2, 1, 0.5)});
  ASSERT_TRUE(pose.has_value());
  EXPECT_NEAR((pose->position_m - Vec2(9, 7)).norm(), 0, 1e-12);
  EXPECT_NEAR(pose->heading_rad, kPi / 2 + 0.5, 1e-12);
  EXPECT_DOUBLE_EQ(pose->height_m, 0.3);
}

TEST(RosFrames, TurnVelocityAndCovarianceOfOdometry) {
  ros::Odometry odometry;
  odometry.pose.pose = pose_at(0, 0, 0);
  odometry.pose.covariance[0] = 0.04;  // along the robot's x axis, the world's y axis
  odometry.pose.covariance[7] = 0.01;
  odometry.twist.twist.linear.x = 0.5;
  const auto pose = turned().pose(odometry);
  ASSERT_TRUE(pose.has_value());
  EXPECT_NEAR((*pose->velocity_mps - Vec2(0, 0.5)).norm(), 0, 1e-12);
  EXPECT_NEAR((*pose->covariance_m2)(0, 0), 0.01, 1e-12);
  EXPECT_NEAR((*pose->covariance_m2)(1, 1), 0.04, 1e-12);
}

TEST(RosFrames, TakeACovarianceOfZeroForNone) {
  ros::Odometry odometry;
  odometry.pose.pose = pose_at(0, 0, 0);
  EXPECT_FALSE(turned().pose(odometry)->covariance_m2.has_value());
}

TEST(RosFrames, RefusePosesThatAreNone) {
  ros::PoseStamped message{.pose = pose_at(1, 2, 0)};
  message.pose.position.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(turned().pose(message).has_value());
  message = {.pose = pose_at(1, 2, 0)};
  message.pose.orientation = {.x = 0, .y = 0, .z = 0, .w = 0};
  EXPECT_FALSE(turned().pose(message).has_value());
}

TEST(RosFrames, CommandInTheFrameOfTheRobotsPoses) {
  EXPECT_NEAR((turned().to_robot_world({0, 1}) - Vec2(1, 0)).norm(), 0, 1e-12);
}

TEST(RosFrames, DriveABaseForwardsAndTurnItToTheNearerSide) {
  const RosFrames sut{RosOptions{}};
  const ros::Twist ahead = sut.drive({0, 0.4}, kPi / 2, 2.0);
  EXPECT_NEAR(ahead.linear.x, 0.4, 1e-12);
  EXPECT_NEAR(ahead.angular.z, 0.0, 1e-12);
  const ros::Twist left = sut.drive({0, 0.4}, 0.0, 2.0);
  EXPECT_EQ(left.linear.x, 0.0);
  EXPECT_NEAR(left.angular.z, 2.0, 1e-12);
  EXPECT_LT(sut.drive({0, -0.4}, 0.0, 2.0).angular.z, 0.0);
  const ros::Twist rest = sut.drive({0, 0}, 1.0, 2.0);
  EXPECT_EQ(rest.linear.x, 0.0);
  EXPECT_EQ(rest.angular.z, 0.0);
}

TEST(RosFrames, SlideABaseThatDrivesSideways) {
  const ros::Twist twist = RosFrames{RosOptions{}}.slide({0, 0.4}, kPi / 2);
  EXPECT_NEAR(twist.linear.x, 0.4, 1e-12);
  EXPECT_NEAR(twist.linear.y, 0.0, 1e-12);
}

TEST(RosTopics, AreBelowTheNamespaceOfTheRobot) {
  EXPECT_EQ(ros_topic("r{id}", "", "cmd_vel", RobotId(7)), "r7/cmd_vel");
  EXPECT_EQ(ros_topic("/fleet/r{id}", "drive", "cmd_vel", RobotId(7)), "fleet/r7/drive");
  EXPECT_EQ(ros_topic("r{id}", "/tb{id}/odom", "odom", RobotId(7)), "tb7/odom");
  EXPECT_EQ(ros_topic("", "", "odom", RobotId(7)), "odom");
}

ros::Time stamp(double seconds) { return ros::time_of(from_seconds(seconds)); }

TEST(StampClock, MeasuresAgeByTheLeastDelay) {
  StampClock sut;
  const SteadyTime now{std::chrono::seconds(50)};
  const auto at = [&](double s) { return now + from_seconds(s); };
  // The robot's clock is 1000 s ahead.
  EXPECT_EQ(sut.age_of(stamp(1050), at(0.02)), Duration::zero());
  EXPECT_NEAR(to_seconds(sut.age_of(stamp(1050.1), at(0.4)).value()), 0.28, 1e-3);
  EXPECT_EQ(sut.age_of(stamp(1050.5), at(0.51)), Duration::zero()) << "faster than ever";
  EXPECT_NEAR(to_seconds(sut.age_of(stamp(1050.6), at(2.61)).value()), 2.0, 1e-3);
}

TEST(StampClock, CountsNoMessageTwiceAndNoneThatIsLate) {
  StampClock sut;
  const SteadyTime now{std::chrono::seconds(50)};
  EXPECT_TRUE(sut.age_of(stamp(10), now).has_value());
  EXPECT_FALSE(sut.age_of(stamp(10), now + from_seconds(0.1)).has_value());
  EXPECT_FALSE(sut.age_of(stamp(9.9), now + from_seconds(0.1)).has_value());
  EXPECT_FALSE(sut.age_of(stamp(10), now + from_seconds(60)).has_value()) << "for good";
}

TEST(StampClock, FollowsAClockThatWasSet) {
  StampClock sut;
  const SteadyTime now{std::chrono::seconds(50)};
  EXPECT_TRUE(sut.age_of(stamp(1000), now).has_value());
  EXPECT_FALSE(sut.age_of(stamp(1), now + from_seconds(0.5)).has_value());
  EXPECT_EQ(sut.age_of(stamp(1.6), now + from_seconds(1.1)), Duration::zero());
  EXPECT_EQ(sut.age_of(stamp(5000), now + from_seconds(1.2)), Duration::zero());
}

TEST(StampClock, TakesMessagesWithoutAStampForNew) {
  StampClock sut;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(sut.age_of({}, SteadyTime(std::chrono::seconds(50 + i))), Duration::zero());
  }
}

TEST(RosPresets, HaveTheNamesThatAMissionMayUse) {
  const auto specs = ros_option_table().specs();
  const auto preset = std::ranges::find(specs, "ros_preset", &OptionSpec::key);
  ASSERT_NE(preset, specs.end());
  for (const std::string& name : preset->choices) EXPECT_NE(find_ros_preset(name), nullptr) << name;
  EXPECT_EQ(find_ros_preset("none"), nullptr);
}

}  // namespace
}  // namespace swarm::drivers
