// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/commands/run.hpp"

#include <algorithm>
#include <cstdio>
#include <thread>
#include <utility>

#include <unistd.h>

#include "swarm_core/app/stop_signal.hpp"
#include "swarm_launcher/flight/flight.hpp"
#include "swarm_launcher/processes/child_process.hpp"
#include "swarm_launcher/processes/described_program.hpp"
#include "swarm_launcher/processes/packing.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

// sysconf() returns -1 for unknown values, which then count as no memory.
Machine this_machine() {
  const auto pages = static_cast<std::uint64_t>(std::max(0L, ::sysconf(_SC_PHYS_PAGES)));
  const auto page_bytes = static_cast<std::uint64_t>(std::max(0L, ::sysconf(_SC_PAGESIZE)));
  return {.cores = std::thread::hardware_concurrency(), .memory_mb = pages * page_bytes >> 20U};
}

}  // namespace

// The priority is raised first, since threads started later inherit it.
Result<ExitCode> run_mission(const RunOptions& options) {
  shell::catch_stop_signals(shell::Hangup::kStop);
  if (options.urgent) become_urgent();
  const auto catalogue = catalogue_of(options.how.agent_program, options.how.planner_program);
  if (!catalogue) return tl::unexpected(catalogue.error());
  auto mission = load_mission(options.mission_file, *catalogue, options.robots);
  if (!mission) return tl::unexpected(mission.error());
  const std::uint32_t robots = mission->robots.count;
  std::uint32_t per_process = options.per_process;
  if (options.processes) {
    per_process = *options.processes > 0 ? (robots + *options.processes - 1) / *options.processes
                                         : robots_per_process(robots, this_machine());
  }
  const auto flight = Flight::make(
      {.mission = std::move(*mission), .per_process = per_process, .how = options.how});
  if (!flight) return tl::unexpected(flight.error());
  std::fprintf(stderr, "run directory: %s\n", (*flight)->dir().c_str());
  const auto measured = (*flight)->fly();
  if (!measured) return tl::unexpected(measured.error());
  if (measured->outcome == Outcome::kPlannerFailed) {
    std::fputs((*flight)->planner_complaint().c_str(), stderr);
  }
  shell::release_stop_signals();  // an audit may take long
  return summarise((*flight)->dir(), *measured, options.json);
}

}  // namespace swarm::launcher
