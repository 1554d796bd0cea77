// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "swarmflow/core/result.hpp"
#include "swarmflow/robot/run_robot.hpp"

namespace swarm::agent {

/// Options of `robot_agent --check-driver`.
struct DriverCheckRequest {
  std::filesystem::path mission;  ///< a mission whose keys have been checked
  std::uint32_t robot = 0;
  double room_m = 2.0;
  double speed_mps = 0.0;  ///< 0: that of DriverCheckOptions, at most the robot's own
  bool may_kill = false;
  std::string cut_pose{};  ///< shell command, called with `cut` and `restore`; empty: none
  bool json = false;
};

/// Checks the driver of one robot of a mission by the steady clock and prints each clause of the
/// contract, on stdout. kCriteriaNotMet if one is broken. No planner, launcher or bus takes part.
Result<ExitCode> run_driver_check(const DriverCheckRequest& request, const RobotRegistry& registry);

}  // namespace swarm::agent
