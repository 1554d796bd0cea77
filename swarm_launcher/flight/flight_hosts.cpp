// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Robots of a flight that other hosts start.
#include <cstdio>
#include <thread>

#include <fmt/format.h>

#include "swarm_launcher/flight/flight.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

constexpr Duration kHostsStep = std::chrono::milliseconds(20);
// Logs of hundreds of robots may have gigabytes.
constexpr Duration kLogsTimeout = std::chrono::minutes(3);

}  // namespace

// Listens for other hosts. The last robots are theirs, so that the local processes have the first
// indices.
Result<void> Flight::open_to_hosts(const shell::RunInfo& run) {
  auto server = LineServer::listen({options_.how.interface, options_.how.join_port});
  if (!server) return tl::unexpected(server.error());
  const std::uint32_t first = options_.mission.robots.count - options_.how.remote;
  hosts_.emplace(std::move(*server),
                 HostOffer{.run = run,
                           .first_robot = first,
                           .robots = options_.how.remote,
                           .per_process = options_.per_process,
                           .first_process = first / options_.per_process,
                           .fault = options_.how.fault,
                           .mission_yaml = to_yaml(options_.mission)},
                 options_.mission.link.status_hz, dir_);
  std::fprintf(stderr, "%u robots are for other hosts: swarm_launcher join %s:%u\n",
               options_.how.remote, options_.how.interface.c_str(), hosts_->port());
  return {};
}

/// Waits for the robot logs of other hosts, because the audit covers their robots, too.
void Flight::collect_robot_logs() {
  const auto until = std::chrono::steady_clock::now() + kLogsTimeout;
  while (hosts_ && !hosts_->collect() && std::chrono::steady_clock::now() < until) {
    progress_.show("ending", fmt::format("{} robot logs under way", hosts_->missing_logs()));
    std::this_thread::sleep_for(kHostsStep);
  }
  if (hosts_ && hosts_->missing_logs() > 0) {
    log({.warning = true,
         .code = "boxes-missing",
         .text = fmt::format("{} robot logs of other hosts did not come", hosts_->missing_logs())});
  }
}

}  // namespace swarm::launcher
