// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_drivers/ros/ros_robot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "swarmflow/robot/unicycle_law.hpp"

namespace swarm::drivers {
namespace {

double wrapped(double angle_rad) { return std::remainder(angle_rad, 2.0 * std::numbers::pi); }

bool is_finite(const ros::Pose& pose) {
  const ros::Point& p = pose.position;
  const ros::Quaternion& q = pose.orientation;
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::isfinite(q.x) &&
         std::isfinite(q.y) && std::isfinite(q.z) && std::isfinite(q.w);
}

/// Rotation about the vertical axis; empty for a quaternion of length zero.
std::optional<double> yaw_rad(const ros::Quaternion& q) {
  const double squared = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  if (squared < 0.25) return std::nullopt;
  return std::atan2(2.0 * (q.w * q.z + q.x * q.y), squared - 2.0 * (q.y * q.y + q.z * q.z));
}

}  // namespace

const RosPreset* find_ros_preset(const std::string& name) {
  static const std::array<RosPreset, 5> kPresets{
      {{"base", RosCommand::kTwist, "cmd_vel", true, "odom", false},
       {"base_stamped", RosCommand::kTwistStamped, "cmd_vel", true, "odom", false},
       {"omni", RosCommand::kBodyTwist, "cmd_vel", true, "odom", false},
       {"crazyswarm2", RosCommand::kVelocityWorld, "cmd_velocity_world", false, "pose", true},
       {"ardupilot", RosCommand::kWorldTwist, "ap/cmd_vel", false, "ap/pose/filtered", true}}};
  const auto found = std::ranges::find(kPresets, name, &RosPreset::name);
  return found == kPresets.end() ? nullptr : &*found;
}

std::string ros_topic(const std::string& name_space, const std::string& chosen,
                      const std::string& usual, RobotId robot) {
  const std::string& name = chosen.empty() ? usual : chosen;
  std::string topic = name.starts_with('/') || name_space.empty() ? name : name_space + "/" + name;
  const std::string kId = "{id}";
  for (std::size_t at; (at = topic.find(kId)) != std::string::npos;) {
    topic.replace(at, kId.size(), std::to_string(robot.value()));
  }
  topic.erase(0, topic.find_first_not_of('/'));
  return topic;
}

RosFrames::RosFrames(const RosOptions& options)
    : options_(options),
      cos_(std::cos(options.origin_yaw_rad)),
      sin_(std::sin(options.origin_yaw_rad)) {}

std::optional<RosPose> RosFrames::place(const ros::Pose& pose, const ros::Time& stamp) const {
  if (!is_finite(pose)) return std::nullopt;
  const auto yaw = yaw_rad(pose.orientation);
  if (!yaw) return std::nullopt;
  const double x = pose.position.x, y = pose.position.y;
  return RosPose{.position_m = {options_.origin_x_m + cos_ * x - sin_ * y,
                                options_.origin_y_m + sin_ * x + cos_ * y},
                 .heading_rad = wrapped(*yaw + options_.origin_yaw_rad),
                 .height_m = pose.position.z,
                 .stamp = stamp};
}

std::optional<RosPose> RosFrames::pose(const ros::PoseStamped& message) const {
  return place(message.pose, message.header.stamp);
}

/// The twist of odometry is in the frame of the robot. A covariance of zero is one that the sender
/// did not fill in.
std::optional<RosPose> RosFrames::pose(const ros::Odometry& message) const {
  auto pose = place(message.pose.pose, message.header.stamp);
  if (!pose) return pose;
  const ros::Vector3& v = message.twist.twist.linear;
  if (std::isfinite(v.x) && std::isfinite(v.y)) {
    const double c = std::cos(pose->heading_rad), s = std::sin(pose->heading_rad);
    pose->velocity_mps = Vec2(c * v.x - s * v.y, s * v.x + c * v.y);
  }
  const ros::Covariance& all = message.pose.covariance;
  Mat2 covariance;
  covariance << all[0], all[1], all[6], all[7];
  if (covariance.allFinite() && covariance.trace() > 0.0) {
    Mat2 turn;
    turn << cos_, -sin_, sin_, cos_;
    pose->covariance_m2 = turn * covariance * turn.transpose();
  }
  return pose;
}

Vec2 RosFrames::to_robot_world(const Vec2& velocity_mps) const {
  return {cos_ * velocity_mps.x() + sin_ * velocity_mps.y(),
          -sin_ * velocity_mps.x() + cos_ * velocity_mps.y()};
}

ros::Twist RosFrames::drive(const Vec2& velocity_mps, double heading_rad,
                            double turn_rate_max_radps) const {
  const auto motion = agent::follow_by_unicycle(heading_rad, velocity_mps, turn_rate_max_radps,
                                                options_.turn_time_s);
  ros::Twist twist;
  twist.linear.x = motion.speed_mps;
  twist.angular.z = motion.turn_rad / options_.turn_time_s;
  return twist;
}

ros::Twist RosFrames::slide(const Vec2& velocity_mps, double heading_rad) const {
  const double c = std::cos(heading_rad), s = std::sin(heading_rad);
  ros::Twist twist;
  twist.linear.x = c * velocity_mps.x() + s * velocity_mps.y();
  twist.linear.y = -s * velocity_mps.x() + c * velocity_mps.y();
  return twist;
}

}  // namespace swarm::drivers
