// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// Options of `swarm_launcher check-driver`.
struct CheckDriverOptions {
  std::filesystem::path mission_file;
  std::filesystem::path agent_program{};  ///< that has the driver; empty: our own
  std::uint32_t robot = 0;
  std::vector<std::string> more{};  ///< options for the robot program as they are
};

/// `swarm_launcher check-driver`: reads the mission with the keys of the robot program, which then
/// checks the driver and prints the result. Returns its exit code.
Result<ExitCode> check_driver(const CheckDriverOptions& options);

}  // namespace swarm::launcher
