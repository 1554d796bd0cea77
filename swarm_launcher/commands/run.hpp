// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "swarmflow/core/result.hpp"
#include "swarm_launcher/flight/flight_choices.hpp"

namespace swarm::launcher {

struct RunOptions {
  std::filesystem::path mission_file;
  std::optional<std::uint32_t> robots;       ///< instead of the mission's
  std::uint32_t per_process = 1;             ///< robots, unless …
  std::optional<std::uint32_t> processes{};  ///< of agents; 0: as the machine can take
  bool json = false;
  FlightChoices how{};
};

/// `swarm_launcher run`: the whole mission with real processes, from planning to the audited
/// report. Result on stdout, progress on stderr.
Result<ExitCode> run_mission(const RunOptions& options);

}  // namespace swarm::launcher
