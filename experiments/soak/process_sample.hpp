// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include <sys/types.h>

namespace swarm::launcher {

/// Resources that a process uses now, as counted by the kernel.
struct ProcessSample {
  double cpu_s = 0.0;   ///< user + system
  double rss_mb = 0.0;  ///< resident memory
  std::uint32_t threads = 0;
  std::uint32_t open_files = 0;
  std::uint64_t context_switches = 0;  ///< of its main thread
};

/// Empty when there is no such process (any more).
std::optional<ProcessSample> sample_process(pid_t pid);

/// Datagrams that the kernel dropped since the machine started because a socket's buffer was full.
std::uint64_t udp_receive_drops();

}  // namespace swarm::launcher
