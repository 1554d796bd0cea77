// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include <sys/types.h>

#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// Which monitors a run starts.
struct MonitorOptions {
  bool record = false;         ///< record the bus
  bool view = false;           ///< serve the view
  bool allow_control = false;  ///< by the view
};

/// The swarm_monitor processes that a launcher starts for its run. The flight does not depend on
/// them: one that ends is reported and not restarted.
class Monitors {
 public:
  Monitors(MonitorOptions options, std::filesystem::path run_dir)
      : options_(options), run_dir_(std::move(run_dir)) {}
  ~Monitors();
  Monitors(const Monitors&) = delete;
  Monitors& operator=(const Monitors&) = delete;

  Result<void> start();

  /// Address of the view, once, as soon as it is known.
  std::optional<std::string> view_address();

  /// The monitor that ended, and a message for the log; empty if the child was none.
  struct Exit {
    bool is_recorder = false;  ///< the recording is not whole
    std::string message;
  };
  std::optional<Exit> on_exit(pid_t pid);

  /// Requests their end and waits until the recording is complete, a few seconds at most.
  void finish();

 private:
  MonitorOptions options_;
  std::filesystem::path run_dir_;
  std::map<pid_t, std::string> running_;  // subcommand by process
  bool reported_ = false;
};

}  // namespace swarm::launcher
