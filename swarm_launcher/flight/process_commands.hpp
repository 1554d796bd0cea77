// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "swarm_launcher/flight/flight_choices.hpp"
#include "swarm_launcher/supervision/supervisor.hpp"

namespace swarm::launcher {

/// How a process of a run is started.
struct ProcessCommand {
  std::vector<std::string> line;  ///< program and arguments
  std::filesystem::path log;      ///< file of its output
};

/// The planner of a run.
ProcessCommand planner_command(const FlightChoices& how, const std::filesystem::path& dir);

/// An agent process of a run, which hosts `count` robots from `first` on.
ProcessCommand agent_command(const FlightChoices& how, const std::filesystem::path& dir,
                             ProcessIndex process, RobotId first, std::uint32_t count);

}  // namespace swarm::launcher
