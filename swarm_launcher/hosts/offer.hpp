// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "swarm_core/app/run_directory.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// A launcher's offer to another host that joins: how to meet, which robots the host flies, and the
/// mission. The other host fills in `run.interface` itself.
struct HostOffer {
  shell::RunInfo run;
  std::uint32_t first_robot = 0;
  std::uint32_t robots = 0;
  std::uint32_t per_process = 1;
  std::uint32_t first_process = 0;  ///< number of its first agent process in the run, from 0
  std::string fault{};              ///< simulated network faults, see parse_link_faults()
  std::string mission_yaml;         ///< the resolved mission
  UtcTime sent_at{};                ///< by the launcher's clock, which is that of the run
};

/// One line of JSON. A received one is not trusted: every field is checked.
std::string to_line(const HostOffer& offer);
Result<HostOffer> parse_offer(const std::string& line);

}  // namespace swarm::launcher
