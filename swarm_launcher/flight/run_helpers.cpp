// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/run_helpers.hpp"

#include <csignal>
#include <memory>
#include <utility>

#include <unistd.h>

#include "swarm_launcher/flight/gateway.hpp"
#include "swarm_launcher/flight/gateway_beat.hpp"

namespace swarm::launcher {

RunHelpers::RunHelpers(const FlightChoices& how, const std::filesystem::path& run_dir)
    : monitors_(how.monitors, run_dir) {
  if (how.by_gateway > 0) {
    gateway_.emplace(
        GatewayKeeper::Means{.start = [run_dir] { return start_gateway(run_dir); },
                             .end = [](pid_t pid) { ::kill(pid, SIGTERM); },
                             .kill = [](pid_t pid) { ::kill(pid, SIGKILL); },
                             .beat = [beats = std::make_shared<GatewayBeatReceiver>(::getpid())](
                                         pid_t pid) { return beats->take(pid); }});
  }
}

// A run that needs a gateway does not begin without one.
Result<void> RunHelpers::start(SteadyTime now) {
  if (auto started = monitors_.start(); !started) return started;
  return gateway_ ? gateway_->start(now) : Result<void>{};
}

std::optional<LogEvent> RunHelpers::on_exit(pid_t pid, SteadyTime now) {
  if (const auto monitor = monitors_.on_exit(pid)) {
    return LogEvent{.warning = true,
                    .code = std::string(monitor->is_recorder ? kRecorderExit : kMonitorExit),
                    .text = monitor->message};
  }
  return gateway_ ? gateway_->on_exit(pid, now) : std::nullopt;
}

std::vector<LogEvent> RunHelpers::step(SteadyTime now) {
  std::vector<LogEvent> events;
  if (gateway_) {
    if (auto event = gateway_->step(now)) events.push_back(*std::move(event));
  }
  return events;
}

std::optional<std::string> RunHelpers::message() {
  const auto address = monitors_.view_address();
  if (!address) return std::nullopt;
  return "view: " + *address;
}

}  // namespace swarm::launcher
