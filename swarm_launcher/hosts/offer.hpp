// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "swarmflow/core/result.hpp"
#include "swarm_core/app/run_directory.hpp"

namespace swarm::launcher {

/// What a launcher tells another host that joins: how to meet, which robots are its, and the
/// mission. `run.interface` is for the other host to fill in.
struct HostOffer {
  shell::RunInfo run;
  std::uint32_t first_robot = 0;
  std::uint32_t robots = 0;
  std::uint32_t per_process = 1;
  std::uint32_t first_process = 0;  ///< number of its first agent process in the run, from 0
  std::string fault{};       ///< a bad network for its robots, as parse_link_faults() reads it
  std::string mission_yaml;  ///< resolved
};

/// One line of JSON. Another host's is checked as hostile.
std::string to_line(const HostOffer& offer);
Result<HostOffer> parse_offer(const std::string& line);

}  // namespace swarm::launcher
