// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace swarm::launcher {

/// Limits of this machine that matter for a run.
struct HostLimits {
  std::uint64_t open_files = 0;  ///< of a process
  std::uint64_t threads = 0;     ///< of this user
  bool autogroup = false;        ///< the scheduler divides the CPU by session first
};
HostLimits read_host_limits();

/// Raises the limit of open files of this process and its future children as far as the machine
/// allows: a process of a thousand robots has a thousand robot logs open, and shells grant 1024
/// files.
void raise_open_files();

/// Size of a run.
struct RunSize {
  std::uint32_t agents = 0;  ///< processes
  std::uint32_t robots_per_process = 1;
  std::uint32_t relays = 0;  ///< relay participants of the launcher
};

/// Limits that are too low for a run of this size, each with a remedy. These are estimates: a run
/// that really fails reports it where it fails.
std::vector<std::string> shortcomings(const HostLimits& limits, const RunSize& run);

}  // namespace swarm::launcher
