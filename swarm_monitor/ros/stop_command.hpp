// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

#include <sys/types.h>

#include "swarmflow/core/time.hpp"

namespace swarm::monitor {

/// The emergency stop of a run, by `swarm_launcher command RUN_DIR stop` in a process of its own:
/// that also reaches robots whose launcher hangs, and takes seconds where one does not answer.
/// Started again until it succeeds, for kTries at most. One thread.
class StopCommand {
 public:
  static constexpr Duration kTries = std::chrono::seconds(20);

  explicit StopCommand(std::filesystem::path run_dir) : run_dir_(std::move(run_dir)) {}
  ~StopCommand();
  StopCommand(const StopCommand&) = delete;
  StopCommand& operator=(const StopCommand&) = delete;

  void request(SteadyTime now) {
    if (!is_pending(now)) requested_at_ = now;
  }
  /// Whether a stop was requested that has not succeeded so far.
  bool is_pending(SteadyTime now) const {
    return requested_at_ && !is_done_ && now - *requested_at_ < kTries;
  }
  /// To be called often. Does not block.
  void step(SteadyTime now);

 private:
  std::filesystem::path run_dir_;
  std::optional<pid_t> child_;
  std::optional<SteadyTime> requested_at_;
  std::optional<SteadyTime> failed_at_;
  bool is_done_ = false;
};

}  // namespace swarm::monitor
