// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/phase.hpp"

namespace swarm::launcher {

/// A command that the launcher published.
struct SentCommand {
  CommandKind kind = CommandKind::kStart;
  std::uint64_t id = 0;
  UtcTime stamp{};  ///< on the run's clock
};

/// What a robot's status states about commands.
struct Obedience {
  RobotMode mode = RobotMode::kWaiting;
  std::uint64_t command_id = 0;  ///< of the newest command that it obeys
  UtcTime stamp{};               ///< of the status, on the run's clock
};

/// Whether a robot in this mode obeys. A robot that has arrived or has stopped for good stays so,
/// whatever the phase is.
inline bool obeys(RobotMode mode, CommandKind kind) {
  switch (kind) {
    case CommandKind::kStart:
      return mode != RobotMode::kWaiting;
    case CommandKind::kPause:
      return mode != RobotMode::kMoving;
    case CommandKind::kResume:
      return mode != RobotMode::kHolding;
    case CommandKind::kStop:
      break;
  }
  return mode == RobotMode::kStopped;
}

/// Whether a status that was received at `now` confirms a command: it names the command, its mode
/// obeys, and by its stamp it was published after the command and not in the future. Stamps may be
/// off by `tolerance`. A stop is final, so a later command, such as a stop of another sender, may
/// stand for it.
inline bool confirms(const Obedience& status, const SentCommand& command, UtcTime now,
                     Duration tolerance) {
  const bool names_it = command.kind == CommandKind::kStop ? status.command_id >= command.id
                                                           : status.command_id == command.id;
  return names_it && obeys(status.mode, command.kind) &&
         status.stamp >= command.stamp - tolerance && status.stamp <= now + tolerance;
}

}  // namespace swarm::launcher
