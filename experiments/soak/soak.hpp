// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "experiments/soak/soak_result.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// Options of the command line.
struct SoakOptions {
  std::uint32_t processes = 100;  ///< of agents
  std::uint32_t per_process = 1;  ///< robots that each of them hosts
  double rate_hz = 10.0;          ///< of control
  double duration_s = 60.0;
  std::uint64_t seed = 1;
  std::optional<Channel> channel{};  ///< empty: choose_channel() decides
  std::string fault{};               ///< as parse_link_faults() reads it
  SoakCriteria criteria{};
  std::filesystem::path out{};  ///< run directory; empty: runs/soak-<time>
  int domain = -1;
  bool urgent = false;  ///< raise the launcher's priority (niceness −10)
  bool json = false;    ///< print JSON instead of text
};

/// `swarm_launcher soak`: keeps a swarm moving for a given time and measures its link and its
/// processes. Result on stdout, soak.json and soak.html in the run directory.
Result<ExitCode> soak(const SoakOptions& options);

}  // namespace swarm::launcher
