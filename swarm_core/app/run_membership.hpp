// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/result.hpp"

/// What a process checks before it takes part in a run.
namespace swarm::shell {

/// kBadInput if the run has ended: its record is complete, and nothing may be added to it.
Result<void> check_run_goes_on(const std::filesystem::path& run_dir);

/// The right of one process to move some robots of a run. Two processes with the same robot would
/// send contradicting states under one id, and write one log. The kernel releases the lock when the
/// process ends, however it ends. It covers one run directory: robots that another host moves have
/// another one.
class RobotLock {
 public:
  /// Locks the robots first … first + count − 1. kBadInput if another process has locked one of
  /// them. In a run directory that is gone or read-only, or on a file system without locks, robots
  /// move without the lock: a flight does not depend on its disk.
  static Result<RobotLock> take(const std::filesystem::path& run_dir, RobotId first,
                                std::uint32_t count);

  RobotLock(RobotLock&& other) noexcept;
  RobotLock& operator=(RobotLock&&) = delete;
  ~RobotLock();

 private:
  explicit RobotLock(int file) : file_(file) {}
  int file_;  ///< closing it releases the lock; -1: none
};

}  // namespace swarm::shell
