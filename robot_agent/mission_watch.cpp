// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/mission_watch.hpp"

namespace swarm::agent {

MissionWatch::Outcome MissionWatch::on_command(CommandKind kind, std::uint64_t command_id) {
  if (kind == CommandKind::kStop) {
    const bool again = phase_ == MissionPhase::kStopped;
    phase_ = MissionPhase::kStopped;
    return again ? Outcome::kDuplicate : Outcome::kObeyed;
  }
  if (command_id == last_command_) return Outcome::kDuplicate;
  if (command_id < last_command_) return Outcome::kStale;
  last_command_ = command_id;
  phase_ = phase_after(phase_, kind);
  return Outcome::kObeyed;
}

}  // namespace swarm::agent
