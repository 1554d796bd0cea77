// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/run.hpp"

#include <cstdio>
#include <utility>

#include "swarm_core/mission/mission_file.hpp"
#include "swarm_launcher/child_process.hpp"
#include "swarm_launcher/flight.hpp"

namespace swarm::launcher {

Result<ExitCode> run_mission(const RunOptions& options) {
  become_urgent();
  auto mission = load_mission(options.mission_file);
  if (!mission) return tl::unexpected(mission.error());
  if (options.robots) mission->robots.count = *options.robots;
  const auto flight = Flight::make({.mission = std::move(*mission),
                                    .per_process = options.per_process,
                                    .seed = options.seed,
                                    .fault = options.fault,
                                    .out = options.out,
                                    .domain = options.domain,
                                    .channel = options.channel});
  if (!flight) return tl::unexpected(flight.error());
  std::fprintf(stderr, "run directory: %s\n", (*flight)->dir().c_str());
  const auto measured = (*flight)->fly();
  if (!measured) return tl::unexpected(measured.error());
  if (measured->outcome == Outcome::kPlannerFailed) {
    std::fputs((*flight)->planner_complaint().c_str(), stderr);
  }
  return summarise((*flight)->dir(), *measured, options.json);
}

}  // namespace swarm::launcher
