// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include <sys/types.h>

#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// Options of `swarm_launcher gateway`.
struct GatewayCommandOptions {
  std::filesystem::path run_dir;
  std::uint32_t parent_pid = 0;  ///< exit when this process is no longer the parent; 0: never
};

/// `swarm_launcher gateway`: forwards the robot states of a run between groups and topics until it
/// receives a stop signal.
Result<ExitCode> run_gateway(const GatewayCommandOptions& options);

/// Starts `swarm_launcher gateway` as a child, as start_process() does, with logs/gateway.log.
Result<pid_t> start_gateway(const std::filesystem::path& run_dir);

}  // namespace swarm::launcher
