// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/gateway.hpp"

#include <chrono>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "swarm_core/app/run_directory.hpp"
#include "swarm_core/app/stop_signal.hpp"
#include "swarm_core/base/clock.hpp"
#include "swarm_launcher/flight/gateway_beat.hpp"
#include "swarm_launcher/processes/child_process.hpp"
#include "swarm_link/gateway/gateway.hpp"
#include "swarm_link/roles/run_meeting.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

// Longest wait for states, and so the delay of a stop request.
constexpr Duration kTimeout = std::chrono::milliseconds(5);

}  // namespace

// Reads mission and run information from the run directory, then forwards states until a stop
// signal arrives or the launcher, its parent, has ended.
Result<ExitCode> run_gateway(const GatewayCommandOptions& options) {
  shell::catch_stop_signals(shell::Hangup::kStop);
  const auto mission = load_mission(options.run_dir / shell::kMissionFile, open_catalogue());
  if (!mission) return tl::unexpected(mission.error());
  const auto run = shell::read_run_info(options.run_dir);
  if (!run) return tl::unexpected(run.error());
  shell::follow(run->clock);
  if (run->channel != Channel::kGroups) {
    return fail(ErrorCode::kBadInput, "this run's states go by topics: no gateway is needed");
  }
  const auto participant = link::join_as_gateway(link::meeting_of(*run));
  if (!participant) return tl::unexpected(participant.error());
  const auto gateway =
      link::make_gateway(**participant, {.domain = run->domain,
                                         .topic_cell_size_m = mission->link.cell_size_m,
                                         .group_cell_size_m = mission->link.group_cell_size_m,
                                         .interface = run->interface,
                                         .limits = link::wire_limits(*mission)});
  if (!gateway) return tl::unexpected(gateway.error());
  // Robots publish more often than this, however they stand.
  const Duration recent = from_seconds(mission->link.send_interval_max_s) + std::chrono::seconds(1);
  GatewayBeatSender beat(static_cast<pid_t>(options.parent_pid));
  while (
      shell::stop_requests() == 0 &&
      (options.parent_pid == 0 || static_cast<std::uint32_t>(::getppid()) == options.parent_pid)) {
    (*gateway)->relay(kTimeout, utc_now());
    const SteadyTime now = std::chrono::steady_clock::now();
    if (beat.is_due(now)) beat.send((*gateway)->robots_by_topics(utc_now(), recent), now);
  }
  using link::RefusalReason;
  const link::RefusalCounters& refused = (*gateway)->refused();
  const std::uint64_t echoes = refused[RefusalReason::kDuplicate] + refused[RefusalReason::kStale];
  const std::string counts = fmt::format(
      "{} states to topics, {} to groups, {} refused, {} echoes\n", (*gateway)->to_topics(),
      (*gateway)->to_groups(), refused.total() - echoes, echoes);
  std::fputs(counts.c_str(), stderr);  // fmt::print() would throw without a reader
  return ExitCode::kOk;
}

Result<pid_t> start_gateway(const std::filesystem::path& run_dir) {
  return start_process({sibling_program("swarm_launcher"), "gateway", run_dir.string(), "--parent",
                        fmt::format("{}", ::getpid())},
                       run_dir / shell::kLogsFolder / "gateway.log");
}

}  // namespace swarm::launcher
