// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace swarm::launcher {

/// What this machine lets a run have.
struct HostLimits {
  std::uint64_t open_files = 0;  ///< of a process
  std::uint64_t threads = 0;     ///< of this user
  bool autogroup = false;        ///< the scheduler shares out by session first
};
HostLimits read_host_limits();

/// Lets this process and the children it will have open as many files as the machine allows: a
/// process of a thousand robots has a thousand robot logs, and shells grant 1024.
void raise_open_files();

struct RunSize {
  std::uint32_t agents = 0;  ///< processes
  std::uint32_t robots_per_process = 1;
  std::uint32_t relays = 0;
};

/// What falls short for a run of this size, each with how to mend it. Nothing here is certain to
/// fail: a run that does says so where it does.
std::vector<std::string> shortcomings(const HostLimits& limits, const RunSize& run);

}  // namespace swarm::launcher
