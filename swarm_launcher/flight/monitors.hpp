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

struct MonitorOptions {
  bool record = false;
  bool view = false;
  bool allow_control = false;  ///< by the view
};

/// The swarm_monitor processes that look on at a run for its launcher. Nothing of the flight
/// depends on them: one that dies is given of and not started again.
class Monitors {
 public:
  Monitors(MonitorOptions options, std::filesystem::path run_dir)
      : options_(options), run_dir_(std::move(run_dir)) {}
  ~Monitors();
  Monitors(const Monitors&) = delete;
  Monitors& operator=(const Monitors&) = delete;

  Result<void> start();

  /// Where the view can be opened, once, as soon as it is known.
  std::optional<std::string> view_address();

  /// If the child that has ended was one of them: what to tell.
  std::optional<std::string> on_exit(pid_t pid);

  /// Asks them to end and waits until the recording is whole, a few seconds at most.
  void finish();

 private:
  MonitorOptions options_;
  std::filesystem::path run_dir_;
  std::map<pid_t, std::string> running_;  // by what they do
  bool reported_ = false;
};

}  // namespace swarm::launcher
