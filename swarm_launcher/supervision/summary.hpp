// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "swarm_core/mission/channel.hpp"
#include "swarm_launcher/supervision/supervisor.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::launcher {

/// Measurements that only the launcher can make.
struct Measurements {
  Outcome outcome = Outcome::kNone;
  std::optional<Channel> channel;       ///< empty: in lock-step
  double discovery_s = -1.0;            ///< negative: never complete
  double neighbour_discovery_s = -1.0;  ///< from then until all receive their neighbours
  double cpu_s = 0.0;                   ///< of all processes of the run
  double max_rss_mb = 0.0;              ///< of the largest child
  std::uint64_t refused_by_launcher = 0;
  std::vector<std::string> missing{};  ///< what is missing in the files of the run, a sentence each
  /// Of a simulation: time of all plans, of the whole simulation, and the median over control
  /// periods.
  std::optional<double> plan_ms, wall_s, ns_per_agent_step;
};

/// Audits the run from its robot logs, adds the launcher's measurements, writes summary.json and
/// the report, prints the result (JSON or for people) to stdout and decides the exit code. A disk
/// that does not take the summary is one more reason not to end with "ok".
Result<ExitCode> summarise(const std::filesystem::path& run_dir, const Measurements& measured,
                           bool json);

}  // namespace swarm::launcher
