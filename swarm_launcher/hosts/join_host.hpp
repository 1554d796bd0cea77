// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

struct JoinOptions {
  std::string launcher;       ///< HOST:PORT
  std::uint32_t robots = 1;   ///< wanted; there may be fewer left
  std::string interface;      ///< address of ours; empty: the one the launcher is reached by
  bool cyclone = false;       ///< the agents' DDS
  std::filesystem::path out;  ///< run directory; empty: runs/<mission>-<time>
};

/// `swarm_launcher join`: flies some robots of a run that another host's launcher leads, until that
/// one ends them or goes away, and sends their robot logs home.
Result<ExitCode> join_host(const JoinOptions& options);

}  // namespace swarm::launcher
