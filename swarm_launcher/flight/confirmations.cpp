// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/confirmations.hpp"

#include <fmt/format.h>

namespace swarm::launcher {

void Confirmations::wait_for(ClientId client, CommandKind kind, SteadyTime now) {
  waiting_.push_back({client, kind, now});
}

// The newest one of its kind: robots name only the newest command.
void Confirmations::on_sent(const SentCommand& command) {
  for (Waiting& waiting : waiting_) {
    if (waiting.kind == command.kind) waiting.command = command;
  }
}

void Confirmations::on_status(RobotId robot, const Obedience& reported, UtcTime now) {
  robots_.at(robot.value()) = {reported, now};
}

std::uint32_t Confirmations::confirmed(const Waiting& waiting,
                                       const std::vector<bool>& is_lost) const {
  if (!waiting.command) return 0;
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    const auto& robot = robots_[i];
    if (robot && !is_lost[i] &&
        confirms(robot->reported, *waiting.command, robot->at, stamp_tolerance_)) {
      ++count;
    }
  }
  return count;
}

std::vector<Confirmations::Answer> Confirmations::due(const std::vector<RobotId>& lost,
                                                      SteadyTime now) {
  std::vector<Answer> answers;
  if (waiting_.empty()) return answers;
  std::vector<bool> is_lost(robots_.size(), false);
  for (const RobotId robot : lost) is_lost.at(robot.value()) = true;
  const auto robots = static_cast<std::uint32_t>(robots_.size() - lost.size());
  std::erase_if(waiting_, [&](const Waiting& waiting) {
    const std::uint32_t obeying = confirmed(waiting, is_lost);
    if ((obeying < robots || !waiting.command) && now - waiting.since < kTimeout) return false;
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
