// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// Options of the command line.
struct ChaosOptions {
  std::filesystem::path mission;
  double minutes = 5.0;  ///< no flight begins later
  std::uint64_t seed = 1;
  std::uint32_t robots = 0;     ///< instead of the mission's number; 0: as there
  std::filesystem::path out{};  ///< folder of the run directories; empty: runs/chaos-<time>
  bool json = false;
};

/// `swarm_launcher chaos`: flies a mission again and again with one process a robot, while
/// processes are killed and frozen, the network fails, the disk fills, the clock is set and
/// commands come at random times; audits each flight. What this machine does not allow is left out
/// and reported: without root, full disks and a second host. Every flight has a seed of its own,
/// which its report names and which repeats its faults: `--seed` with `--minutes 0` flies that one
/// alone. kCriteriaNotMet if a flight broke a promise. Call it from the main thread.
Result<ExitCode> chaos(const ChaosOptions& options);

}  // namespace swarm::launcher
