// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "swarmflow/mission/catalogue.hpp"
#include "swarmflow/mission/option_table.hpp"

namespace swarm::drivers {

/// The options of the driver `ros2`, as a mission sets them under `robots:`.
struct RosOptions {
  std::string preset = "base";
  std::string name_space = "r{id}";  ///< of the robot's topics; {id} is its number
  std::string command_topic{};       ///< empty: that of the preset
  std::string pose_topic{};          ///< empty: that of the preset
  std::string battery_topic = "battery_state";
  std::string frame = "map";  ///< of stamped commands
  double turn_time_s = 0.3;   ///< of a base: in which it turns to the commanded direction
  /// Where the origin of the robot's poses is in the world of the mission, and how it is turned.
  double origin_x_m = 0.0;
  double origin_y_m = 0.0;
  double origin_yaw_rad = 0.0;
  double height_m = 0.0;        ///< that a flying robot keeps; 0: it is on the ground
  double stops_within_s = 1.0;  ///< after its last command
};

/// The keys of the driver.
const OptionTable<RosOptions>& ros_option_table();

/// What a catalogue holds of the driver, without the DDS libraries that the driver itself needs.
ComponentSpec ros_driver_spec();

}  // namespace swarm::drivers
