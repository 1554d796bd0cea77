// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/run_helpers.hpp"

namespace swarm::launcher {

RunHelpers::RunHelpers(const FlightChoices& how, const std::filesystem::path& run_dir)
    : monitors_(how.monitors, run_dir) {
  if (how.by_gateway > 0) gateway_.emplace(run_dir);
}

Result<void> RunHelpers::start() {
  if (auto started = monitors_.start(); !started) return started;
  return gateway_ ? gateway_->start() : Result<void>{};
}

std::optional<LogEvent> RunHelpers::on_exit(pid_t pid) {
  if (const auto monitor = monitors_.on_exit(pid)) {
    return LogEvent{.warning = true, .code = "monitor-exit", .text = *monitor};
  }
  if (const auto gateway = gateway_ ? gateway_->on_exit(pid) : std::nullopt) {
    return LogEvent{.warning = true, .code = "gateway-exit", .text = *gateway};
  }
  return std::nullopt;
}

std::optional<std::string> RunHelpers::message() {
  const auto address = monitors_.view_address();
  if (!address) return std::nullopt;
  return "view: " + *address;
}

}  // namespace swarm::launcher
