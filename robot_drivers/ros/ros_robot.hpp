// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "robot_drivers/ros/ros_options.hpp"
#include "swarm_ros/messages.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/robot/driver.hpp"

namespace swarm::drivers {

/// How a family of ROS robots is commanded.
enum class RosCommand {
  kTwist,         ///< forward speed and turn rate, geometry_msgs/Twist
  kTwistStamped,  ///< the same, geometry_msgs/TwistStamped
  kBodyTwist,     ///< velocity in the robot's frame, geometry_msgs/Twist
  kWorldTwist,    ///< velocity in the frame `frame`, geometry_msgs/TwistStamped
  kVelocityWorld  ///< velocity in the world, crazyflie_interfaces/VelocityWorld
};

/// What a preset sets.
struct RosPreset {
  std::string name;
  RosCommand command = RosCommand::kTwist;
  std::string command_topic;
  bool has_odometry = true;  ///< nav_msgs/Odometry; else geometry_msgs/PoseStamped
  std::string pose_topic;
  bool flies = false;
};

/// The preset of a name; null if there is none.
const RosPreset* find_ros_preset(const std::string& name);

/// A topic of a robot: the chosen name, or the usual one if that is empty, below the namespace
/// unless it begins with a slash; {id} is the robot's number. Without a slash at the beginning.
std::string ros_topic(const std::string& name_space, const std::string& chosen,
                      const std::string& usual, RobotId robot);

/// A pose as it came, in the world of the mission.
struct RosPose {
  Vec2 position_m = Vec2::Zero();
  double heading_rad = 0.0;
  double height_m = 0.0;
  std::optional<Vec2> velocity_mps{};
  std::optional<Mat2> covariance_m2{};
  ros::Time stamp{};
};

/// Converts between the messages of one robot and the world of the mission. Pure.
class RosFrames {
 public:
  explicit RosFrames(const RosOptions& options);

  /// Empty for numbers that are not finite, or an orientation that is none.
  std::optional<RosPose> pose(const ros::PoseStamped& message) const;
  std::optional<RosPose> pose(const ros::Odometry& message) const;

  /// A velocity of the world in the frame of the robot's poses.
  Vec2 to_robot_world(const Vec2& velocity_mps) const;
  /// Forward speed and turn rate of a base with this heading, see follow_by_unicycle().
  ros::Twist drive(const Vec2& velocity_mps, double heading_rad, double turn_rate_max_radps) const;
  /// Velocity in the robot's own frame.
  ros::Twist slide(const Vec2& velocity_mps, double heading_rad) const;

 private:
  std::optional<RosPose> place(const ros::Pose& pose, const ros::Time& stamp) const;

  RosOptions options_;
  double cos_ = 1.0;
  double sin_ = 0.0;
};

}  // namespace swarm::drivers
