// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "swarm_launcher/supervision/supervisor.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// A child that has ended, with its resource usage.
struct ExitedChild {
  pid_t pid = 0;
  ProcessExit exit;
  double cpu_s = 0.0;       ///< user + system
  double max_rss_mb = 0.0;  ///< largest resident memory
};

/// Starts, signals and reaps the processes of a run. ChildSpawner does it with the operating
/// system; tests implement it without processes.
class Spawner {
 public:
  virtual ~Spawner() = default;

  /// Starts a program with its output appended to `log`, and returns its process id.
  virtual Result<pid_t> start(const std::vector<std::string>& command_line,
                              const std::filesystem::path& log) = 0;

  /// The next child that has ended, if any; never blocks. Also children that were started by other
  /// means.
  virtual std::optional<ExitedChild> reap() = 0;

  /// Sends a signal to a child that has not been reaped.
  virtual void signal(pid_t pid, EndSignal signal) = 0;
};

}  // namespace swarm::launcher
