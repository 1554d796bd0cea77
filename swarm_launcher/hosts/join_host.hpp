// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "swarm_core/mission/vendor.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// Options of `swarm_launcher join`.
struct JoinOptions {
  std::string launcher;      ///< HOST:PORT
  std::uint32_t robots = 1;  ///< wanted; the launcher may have fewer left
  std::string token{};       ///< that the launcher asks for; empty: none
  std::string interface;     ///< our address; empty: the one on the route to the launcher
  link::Vendor dds = link::Vendor::kFastDds;  ///< of the agents
  std::filesystem::path out;                  ///< run directory; empty: runs/<mission>-<time>
};

/// `swarm_launcher join`: flies some robots of a run that the launcher of another host leads, until
/// that launcher ends them or disappears; then sends their robot logs to it.
Result<ExitCode> join_host(const JoinOptions& options);

}  // namespace swarm::launcher
