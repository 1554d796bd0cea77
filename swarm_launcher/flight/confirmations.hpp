// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "swarm_core/app/control_socket.hpp"
#include "swarm_launcher/flight/sent_command.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/phase.hpp"

namespace swarm::launcher {

/// Answers users that start, pause or resume a mission: with the number of robots whose statuses
/// confirm the command (see confirms()), as soon as all living ones do, or when the time is up. A
/// stop is another matter (StopOrder). A pure class; not thread-safe.
class Confirmations {
 public:
  using ClientId = shell::ControlServer::ClientId;
  /// Statuses come every second and at every change of the mode.
  static constexpr Duration kTimeout = std::chrono::seconds(5);

  /// `stamp_tolerance`: by how much the robots' clocks may differ from the launcher's.
  Confirmations(std::uint32_t robots, Duration stamp_tolerance)
      : robots_(robots), stamp_tolerance_(stamp_tolerance) {}

  /// A client waits for the robots to obey a command that is sent in this step.
  void wait_for(ClientId client, CommandKind kind, SteadyTime now);

  /// A command was sent: those who wait for one of its kind wait for it.
  void on_sent(const SentCommand& command);

  /// A robot's status was received, which passed the Gate. \pre a robot of the mission
  void on_status(RobotId robot, const Obedience& reported, UtcTime now);

  struct Answer {
    ClientId client = 0;
    std::string text;
  };
  /// The answers that are due, each given once. `lost` robots cannot confirm anything.
  std::vector<Answer> due(const std::vector<RobotId>& lost, SteadyTime now);

 private:
  struct Waiting {
    ClientId client = 0;
    CommandKind kind = CommandKind::kPause;
    SteadyTime since;
    std::optional<SentCommand> command{};  ///< empty: not sent yet
  };
  struct Received {
    Obedience reported;
    UtcTime at{};
  };
  /// Robots whose last status confirms the command.
  std::uint32_t confirmed(const Waiting& waiting, const std::vector<bool>& is_lost) const;

  std::vector<std::optional<Received>> robots_;  // last status of each
  Duration stamp_tolerance_;
  std::vector<Waiting> waiting_;
};

}  // namespace swarm::launcher
