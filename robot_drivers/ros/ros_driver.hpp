// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/robot/driver_registry.hpp"

namespace swarm::drivers {

/// Adds the driver `ros2`: a robot that takes velocities and reports its pose by topics of ROS 2.
/// No ROS is installed or started; the process joins the ROS domain that the environment names, as
/// one DDS participant for all its robots. Presets (`ros_preset`) set the topics and types of
/// families of robots:
///
///   base         cmd_vel Twist, odom Odometry: differential bases, Gazebo
///   base_stamped cmd_vel TwistStamped, odom Odometry: the same since Jazzy
///   omni         cmd_vel Twist in the robot's frame, odom Odometry: bases that drive sideways
///   crazyswarm2  cmd_velocity_world VelocityWorld, pose PoseStamped
///   ardupilot    ap/cmd_vel TwistStamped in the frame `map`, ap/pose/filtered PoseStamped
///
/// \pre the name is not taken, asserted
void register_ros_driver(agent::DriverRegistry& registry);

}  // namespace swarm::drivers
