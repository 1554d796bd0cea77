// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "swarmflow/core/result.hpp"

namespace swarm::monitor {

/// Settings of publish_to_ros().
struct RosOutput {
  std::string name_space = "swarm";  ///< of its topics
  std::string frame = "map";         ///< frame_id of its messages
  double rate_hz = 10.0;             ///< of poses and markers
  double resolution_m = 0.1;         ///< of the map
};

/// Publishes a run in progress in the ROS domain of the environment (ros_domain.hpp), until
/// `go_on()` returns false:
///
///   /<ns>/poses           geometry_msgs/PoseArray            rate_hz
///   /<ns>/markers         visualization_msgs/MarkerArray     rate_hz
///   /<ns>/map             nav_msgs/OccupancyGrid, latched    at changes, twice a second at most
///   /diagnostics          diagnostic_msgs/DiagnosticArray    once a second
///
/// and stops the robots (an emergency stop, final) when `true` is received on
/// /<ns>/emergency_stop, std_msgs/Bool.
/// \return kBadInput for a wrong environment, or a map of more cells than a message holds;
///   kEnvironment if the run or the domain cannot be joined
Result<void> publish_to_ros(const std::filesystem::path& run_dir, const RosOutput& output,
                            const std::function<bool()>& go_on);

}  // namespace swarm::monitor
