// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "swarm_launcher/supervision/restart_policy.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// Which process of a joined host is started when: one after the other, as starting processes
/// compete, and again after it ended (see RestartPolicy). Processes are identified by their first
/// robot. Pure; the times are passed in.
class StartQueue {
 public:
  static constexpr Duration kStartEvery = std::chrono::milliseconds(50);

  /// A process is started again after each of its first `respawns` deaths in a row.
  explicit StartQueue(std::uint32_t respawns) : respawns_(respawns) {}

  /// A process to be started for the first time.
  void add(std::uint32_t robot) { waiting_.push_back({.robot = robot}); }

  /// The process has ended. Whether it will be started again.
  bool on_exit(std::uint32_t robot, SteadyTime now);

  /// The process to be started now, which leaves the queue; none if none is due.
  std::optional<std::uint32_t> next(SteadyTime now);

  /// Nothing waits to be started.
  bool is_empty() const { return waiting_.empty(); }

 private:
  struct Waiting {
    std::uint32_t robot = 0;
    SteadyTime due{};  // not before this
  };

  std::uint32_t respawns_;
  std::vector<Waiting> waiting_;
  std::map<std::uint32_t, RestartPolicy> restarts_;
  SteadyTime next_start_{};
};

}  // namespace swarm::launcher
