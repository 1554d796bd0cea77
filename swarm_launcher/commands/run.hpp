// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "swarm_launcher/flight/flight_choices.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// Options of `swarm_launcher run`.
struct RunOptions {
  std::filesystem::path mission_file;
  std::optional<std::uint32_t> robots;       ///< instead of the mission's
  std::uint32_t per_process = 1;             ///< robots, unless `processes` is set
  std::optional<std::uint32_t> processes{};  ///< of agents; 0: chosen for this machine
  bool urgent = false;                       ///< raise the launcher's priority (niceness −10)
  bool json = false;                         ///< print the summary as JSON
  FlightChoices how{};                       ///< everything else the user chooses
};

/// `swarm_launcher run`: flies a mission with real processes, from planning to the audited report.
/// Result on stdout, progress on stderr.
Result<ExitCode> run_mission(const RunOptions& options);

}  // namespace swarm::launcher
