// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_drivers/ros/ros_options.hpp"

namespace swarm::drivers {

const OptionTable<RosOptions>& ros_option_table() {
  static const auto kTable =
      OptionTable<RosOptions>()
          .choice("ros_preset", &RosOptions::preset,
                  {"base", "base_stamped", "omni", "crazyswarm2", "ardupilot"},
                  "family of robots: topics and types")
          .text("ros_namespace", &RosOptions::name_space,
                "namespace of the robot's topics; {id} is its number")
          .text("ros_command_topic", &RosOptions::command_topic,
                "topic of its commands; empty: that of the preset")
          .text("ros_pose_topic", &RosOptions::pose_topic,
                "topic of its pose; empty: that of the preset")
          .text("ros_battery_topic", &RosOptions::battery_topic, "topic of its battery")
          .text("ros_frame", &RosOptions::frame, "ardupilot: frame_id of its commands")
          .number("ros_turn_time_s", &RosOptions::turn_time_s, positive(10),
                  "time in which a base turns to the commanded direction")
          .number("ros_origin_x_m", &RosOptions::origin_x_m, between(-1e6, 1e6),
                  "where the origin of the robot's poses is in the world")
          .number("ros_origin_y_m", &RosOptions::origin_y_m, between(-1e6, 1e6),
                  "where the origin of the robot's poses is in the world")
          .number("ros_origin_yaw_rad", &RosOptions::origin_yaw_rad, between(-7, 7),
                  "how the robot's poses are turned")
          .number("ros_height_m", &RosOptions::height_m, between(0, 1000),
                  "crazyswarm2: height that it keeps; 0: none")
          .number("ros_stops_within_s", &RosOptions::stops_within_s, positive(60),
                  "time from the robot's last command to rest");
  return kTable;
}

ComponentSpec ros_driver_spec() {
  return {.name = "ros2",
          .doc = "A robot of ROS 2, commanded and located by topics",
          .options = ros_option_table().specs(),
          .lag = {.fixed_s = 0.3, .accelerates = true, .turns = true}};
}

}  // namespace swarm::drivers
