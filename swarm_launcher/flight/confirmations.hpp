// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "swarm_core/app/control_socket.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/phase.hpp"

namespace swarm::launcher {

/// Answers users that start, pause or resume a mission: with the number of robots whose statuses
/// show that they obey, as soon as all living ones do, or when the time is up. A stop is another
/// matter (StopOrder). A pure class; not thread-safe.
class Confirmations {
 public:
  using ClientId = shell::ControlServer::ClientId;
  /// Statuses come every second and at every change of the mode.
  static constexpr Duration kTimeout = std::chrono::seconds(5);

  explicit Confirmations(std::uint32_t robots) : modes_(robots) {}

  /// A client waits for the robots to obey a command that was just sent.
  void wait_for(ClientId client, CommandKind kind, SteadyTime now);

  /// A robot's status was received. \pre a robot of the mission
  void on_status(RobotId robot, RobotMode mode, SteadyTime now);

  struct Answer {
    ClientId client = 0;
    std::string text;
  };
  /// The answers that are due, each given once. `lost` robots cannot confirm anything.
  std::vector<Answer> due(std::uint32_t lost, SteadyTime now);

 private:
  struct Waiting {
    ClientId client = 0;
    CommandKind kind = CommandKind::kPause;
    SteadyTime since;
  };
  /// Robots that were received since then in a mode that fits the command.
  std::uint32_t confirmed(const Waiting& waiting) const;

  struct Received {
    RobotMode mode = RobotMode::kWaiting;
    SteadyTime at = SteadyTime::min();
  };
  std::vector<Received> modes_;  // by robot
  std::vector<Waiting> waiting_;
};

}  // namespace swarm::launcher
