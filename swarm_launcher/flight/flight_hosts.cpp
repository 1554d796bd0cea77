// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Robots of a flight that other hosts start.
#include <cstdio>
#include <thread>

#include <fmt/format.h>

#include "swarm_launcher/flight/flight.hpp"

namespace swarm::launcher {
namespace {

constexpr Duration kHostsStep = std::chrono::milliseconds(20);
// Logs of hundreds of robots may have gigabytes.
constexpr Duration kLogsTimeout = std::chrono::minutes(3);

}  // namespace

void Flight::report_hosts() {
  if (run_->hosts() == nullptr) return;
  const FlightChoices& how = run_->options().how;
  std::fprintf(stderr, "%u robots are for other hosts: swarm_launcher join %s:%u\n", how.remote,
               how.interface.c_str(), run_->hosts()->port());
}

/// Waits for the robot logs of other hosts, because the audit covers their robots, too.
void Flight::collect_robot_logs() {
  const auto until = std::chrono::steady_clock::now() + kLogsTimeout;
  while (run_->hosts() != nullptr && !run_->hosts()->collect() &&
         std::chrono::steady_clock::now() < until) {
    progress_.show("ending", fmt::format("{} robot logs under way", run_->hosts()->missing_logs()));
    std::this_thread::sleep_for(kHostsStep);
  }
  if (run_->hosts() != nullptr && run_->hosts()->missing_logs() > 0) {
    log({.warning = true,
         .code = "boxes-missing",
         .text = fmt::format("{} robot logs of other hosts did not come",
                             run_->hosts()->missing_logs())});
  }
}

}  // namespace swarm::launcher
