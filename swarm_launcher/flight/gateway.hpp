// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

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

/// Runs the gateway process of a flight and restarts it when it ends, a limited number of times.
/// Destruction ends the process.
class GatewayKeeper {
 public:
  explicit GatewayKeeper(std::filesystem::path run_dir) : run_dir_(std::move(run_dir)) {}
  ~GatewayKeeper();
  GatewayKeeper(const GatewayKeeper&) = delete;
  GatewayKeeper& operator=(const GatewayKeeper&) = delete;

  Result<void> start();
  /// Restarts the gateway if the child that ended was the gateway, and returns a message for the
  /// log.
  std::optional<std::string> on_exit(pid_t pid);

 private:
  std::filesystem::path run_dir_;
  pid_t pid_ = 0;
  int restarts_ = 0;
};

}  // namespace swarm::launcher
