// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "swarm_core/mission/link_faults.hpp"
#include "swarm_sim/kills.hpp"
#include "swarm_sim/simulated_network.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// The options of `swarm_launcher simulate`.
struct SimulateOptions {
  std::filesystem::path mission_file;
  std::optional<std::uint32_t> robots;  ///< instead of the mission's
  /// Of placement, plan, robots, faults and kills.
  std::uint64_t seed = 1;
  LinkFaults faults;
  /// See SimulationOptions.
  bool clocks_in_step = true;
  std::vector<Kill> kills{};  ///< robots whose processes die
  std::size_t threads = 0;    ///< 0: chosen automatically
  bool record = true;         ///< robot logs, audit and report; otherwise arrivals and times only
  std::filesystem::path out;  ///< run directory; empty: runs/<mission>-<time>
  bool json = false;
};

/// `swarm_launcher simulate`: the mission in lock-step, in one process, as fast as possible; the
/// same run directory and audit as of a real run. Result on stdout, progress on stderr.
Result<ExitCode> simulate_mission(const SimulateOptions& options);

}  // namespace swarm::launcher
