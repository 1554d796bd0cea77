// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/confirmations.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace swarm::launcher {
namespace {

/// A robot that has arrived or has stopped for good stays so, whatever the phase is.
bool obeys(RobotMode mode, CommandKind kind) {
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

}  // namespace

void Confirmations::wait_for(ClientId client, CommandKind kind, SteadyTime now) {
  waiting_.push_back({client, kind, now});
}

void Confirmations::on_status(RobotId robot, RobotMode mode, SteadyTime now) {
  modes_[robot.value()] = {mode, now};
}

std::uint32_t Confirmations::confirmed(const Waiting& waiting) const {
  return static_cast<std::uint32_t>(
      std::count_if(modes_.begin(), modes_.end(), [&](const Received& robot) {
        return robot.at > waiting.since && obeys(robot.mode, waiting.kind);
      }));
}

std::vector<Confirmations::Answer> Confirmations::due(std::uint32_t lost, SteadyTime now) {
  std::vector<Answer> answers;
  const auto robots = static_cast<std::uint32_t>(modes_.size()) - lost;
  std::erase_if(waiting_, [&](const Waiting& waiting) {
    const std::uint32_t obeying = std::min(confirmed(waiting), robots);
    if (obeying < robots && now - waiting.since < kTimeout) return false;
    answers.push_back(
        {waiting.client,
         obeying == robots
             ? fmt::format("done: {} robots confirmed the {}", obeying, to_string(waiting.kind))
             : fmt::format("failed: only {} of {} robots confirmed the {} within {:.0f} s", obeying,
                           robots, to_string(waiting.kind), to_seconds(kTimeout))});
    return true;
  });
  return answers;
}

}  // namespace swarm::launcher
