// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace swarm::launcher {

struct Machine {
  std::uint32_t cores = 1;
  std::uint64_t memory_mb = 0;
};

/// How many robots a process should host: one, as long as the machine carries a process for each
/// (measured on two cores: 500 of them tick in time, 700 do not always). Else as many as it takes
/// to have two processes a core, each of which carries thousands.
std::uint32_t robots_per_process(std::uint32_t robots, const Machine& machine);

}  // namespace swarm::launcher
