// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "swarm_core/mission/link_faults.hpp"
#include "swarm_link/vendor.hpp"
#include "swarmflow/core/ids.hpp"

namespace swarm::agent {

/// The options of robot_agent's command line.
struct ProcessOptions {
  std::filesystem::path run_dir;
  std::filesystem::path inputs{};  ///< see shell::read_run_inputs(); empty: those of run_dir
  std::string steps{};             ///< path of the launcher's shell::SharedSteps; empty: none
  RobotId first;                   ///< the robots first … first + count − 1 run in this process
  std::uint32_t count = 1;
  std::uint32_t number = 0;  ///< of this process among the agents of the run
  LinkFaults faults{};       ///< of what this process receives
  link::Vendor vendor = link::Vendor::kFastDds;
  bool by_gateway = false;       ///< its states go by topics where the others' go by groups
  std::uint32_t parent_pid = 0;  ///< end when this process is gone; 0 = do not watch
};

}  // namespace swarm::agent
