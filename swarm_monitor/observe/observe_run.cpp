// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <thread>
#include <utility>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_monitor/observe/bus_reader.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::monitor {
namespace {

/// Period of the polls: shorter than a control period, so an observer's delay is below one tick.
constexpr Duration kPoll = std::chrono::milliseconds(20);

}  // namespace

/// The observer gets the mission before any message. `go_on` is asked once per poll.
Result<void> observe_run(const std::filesystem::path& run_dir, Observer& observer,
                         const std::function<bool()>& go_on) {
  const auto mission = load_mission(run_dir / shell::kMissionFile, open_catalogue());
  if (!mission) return tl::unexpected(mission.error());
  const auto run = shell::read_run_info(run_dir);
  if (!run) return tl::unexpected(run.error());
  const auto tap = tap_bus(run_dir);
  if (!tap) return tl::unexpected(tap.error());
  observer.on_mission(*mission);
  BusReader reader(*mission, observer, stamps_of(*run));
  while (go_on()) {
    const auto next = std::chrono::steady_clock::now() + kPoll;
    (*tap)->take(Duration(0), [&](const TappedSample& sample) { reader.take(sample); });
    std::this_thread::sleep_until(next);  // take() waits for states only where they go by groups
  }
  return {};
}

}  // namespace swarm::monitor
