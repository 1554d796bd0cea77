// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "swarm_launcher/flight/flight_choices.hpp"
#include "swarm_launcher/flight/flight_ports.hpp"
#include "swarm_launcher/flight/gateway_keeper.hpp"
#include "swarm_launcher/flight/monitors.hpp"

namespace swarm::launcher {

/// The monitors and the gateway that a user chose for a run.
class RunHelpers final : public HelperProcesses {
 public:
  RunHelpers(const FlightChoices& how, const std::filesystem::path& run_dir);

  Result<void> start(SteadyTime now);
  std::optional<LogEvent> on_exit(pid_t pid, SteadyTime now) override;
  std::vector<LogEvent> step(SteadyTime now) override;
  std::uint32_t robots_of_gateway() const override {
    return gateway_ ? gateway_->robots_received() : 0;
  }
  /// The address of the view, as soon as it is known.
  std::optional<std::string> message() override;
  /// Ends the monitors, see Monitors::finish(). The gateway ends with the object.
  void finish() { monitors_.finish(); }

 private:
  Monitors monitors_;
  std::optional<GatewayKeeper> gateway_;
};

}  // namespace swarm::launcher
