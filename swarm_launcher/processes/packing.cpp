// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/processes/packing.hpp"

#include <algorithm>

namespace swarm::launcher {
namespace {

// See the measurement in the header: 500 on two cores, with a reserve.
constexpr std::uint64_t kProcessesPerCore = 200;
constexpr std::uint64_t kProcessMb = 20;  // resident, with its share of shared pages
constexpr std::uint64_t kPackedPerCore = 2;

}  // namespace

std::uint32_t robots_per_process(std::uint32_t robots, const Machine& machine) {
  const std::uint64_t cores = std::max(1U, machine.cores);
  const std::uint64_t by_memory = machine.memory_mb / 2 / kProcessMb;  // half is for other programs
  if (robots <= std::min(kProcessesPerCore * cores, by_memory)) return 1;
  const std::uint64_t processes = std::max<std::uint64_t>(1, kPackedPerCore * cores);
  return static_cast<std::uint32_t>((robots + processes - 1) / processes);
}

}  // namespace swarm::launcher
