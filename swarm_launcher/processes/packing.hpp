// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace swarm::launcher {

/// The machine's resources.
struct Machine {
  std::uint32_t cores = 1;
  std::uint64_t memory_mb = 0;
};

/// Number of robots per process: one if the machine can run a process for each robot (measured on
/// two cores: 500 processes meet their control periods, 700 do not always). Otherwise as many as
/// result in two processes per core, each of which can host thousands.
std::uint32_t robots_per_process(std::uint32_t robots, const Machine& machine);

}  // namespace swarm::launcher
