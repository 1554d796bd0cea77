// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "experiments/soak/soak.hpp"

#include <cstdio>
#include <utility>

#include "experiments/soak/soak_mission.hpp"
#include "experiments/soak/soak_watch.hpp"
#include "swarm_core/app/run_directory.hpp"
#include "swarm_launcher/flight/flight.hpp"
#include "swarm_launcher/processes/child_process.hpp"
#include "swarm_monitor/audit/audit.hpp"

namespace swarm::launcher {

/// Flies the soak's own mission with real processes while SoakWatch measures, audits the recording,
/// and compares all with the criteria. Only the group channel can be tapped by a listener.
Result<ExitCode> soak(const SoakOptions& options) {
  // The discovery server is in this process: starved by hundreds of starting agents it would answer
  // too late.
  if (options.urgent) become_urgent();
  const std::uint32_t robots = options.processes * options.per_process;
  auto mission = soak_mission(robots, options.rate_hz, options.duration_s);
  if (!mission) return tl::unexpected(mission.error());
  SoakWatch watch(robots);
  const auto flight = Flight::make({.mission = std::move(*mission),
                                    .per_process = options.per_process,
                                    .how = {.seed = options.seed,
                                            .fault = options.fault,
                                            .out = options.out,
                                            .domain = options.domain,
                                            .channel = options.channel}},
                                   &watch);
  if (!flight) return tl::unexpected(flight.error());
  const std::filesystem::path& dir = (*flight)->dir();
  std::fprintf(stderr, "run directory: %s\n", dir.c_str());
  if ((*flight)->channel() == Channel::kGroups) {
    auto tap = link::make_group_tap((*flight)->domain());
    if (!tap) return tl::unexpected(tap.error());
    watch.listen(std::move(*tap));
  }
  const auto flown = (*flight)->fly();
  if (!flown) return tl::unexpected(flown.error());

  SoakResult result{.processes = options.processes,
                    .per_process = options.per_process,
                    .rate_hz = options.rate_hz,
                    .duration_s = options.duration_s,
                    .channel = (*flight)->channel(),
                    .discovery_s = flown->discovery_s,
                    .cpu_s = flown->cpu_s,
                    .measured = watch.measurements(),
                    .flown = flown->outcome == Outcome::kTimeLimit};
  const auto audit = monitor::audit_run(dir);
  if (!audit) return tl::unexpected(audit.error());
  result.collisions = audit->collisions_robot + audit->collisions_obstacle;
  const auto found = complaints(result, options.criteria);
  const std::string json = to_json(result, found);
  if (auto w = shell::write_file(dir / "soak.json", json); !w) return tl::unexpected(w.error());
  if (auto w = shell::write_file(dir / "soak.html", to_html(result, found)); !w) {
    return tl::unexpected(w.error());
  }
  std::fputs(options.json ? json.c_str() : to_text(result, found).c_str(), stdout);
  if (!options.json) std::printf("  report           %s\n", (dir / "soak.html").c_str());
  return found.empty() ? ExitCode::kOk : ExitCode::kCriteriaNotMet;
}

}  // namespace swarm::launcher
