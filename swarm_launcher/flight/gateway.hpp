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

struct GatewayCommandOptions {
  std::filesystem::path run_dir;
  std::uint32_t parent_pid = 0;  ///< end when this process is no longer our parent
};

/// `swarm_launcher gateway`: carries the robot states of a run between groups and topics until it
/// is given to stop.
Result<ExitCode> run_gateway(const GatewayCommandOptions& options);

/// The gateway process of a flight, started again whenever it ends.
class GatewayKeeper {
 public:
  explicit GatewayKeeper(std::filesystem::path run_dir) : run_dir_(std::move(run_dir)) {}
  ~GatewayKeeper();
  GatewayKeeper(const GatewayKeeper&) = delete;
  GatewayKeeper& operator=(const GatewayKeeper&) = delete;

  Result<void> start();
  /// If the child that has ended was it: starts it again, and says so.
  std::optional<std::string> on_exit(pid_t pid);

 private:
  std::filesystem::path run_dir_;
  pid_t pid_ = 0;
  int restarts_ = 0;
};

}  // namespace swarm::launcher
