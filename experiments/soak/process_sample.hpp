// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include <sys/types.h>

namespace swarm::launcher {

/// What the kernel says of a process, as of now.
struct ProcessSample {
  double cpu_s = 0.0;  ///< user + system
  double rss_mb = 0.0;
  std::uint32_t threads = 0;
  std::uint32_t open_files = 0;
  std::uint64_t context_switches = 0;  ///< of its main thread
};

/// Empty when there is no such process (any more).
std::optional<ProcessSample> sample_process(pid_t pid);

/// Datagrams the kernel threw away since the machine started because a socket's buffer was full.
std::uint64_t udp_receive_drops();

}  // namespace swarm::launcher
