// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/hosts/step_watch.hpp"

namespace swarm::launcher {

std::vector<StepWatch::Change> StepWatch::step(SteadyTime now) {
  std::vector<Change> changes;
  if (now < next_look_) return changes;
  next_look_ = now + kPeriod;
  for (std::uint32_t i = 0; i < robots_.size(); ++i) {
    Robot& robot = robots_[i];
    const RobotId id(first_.value() + i);
    const auto steps = steps_.last(id);
    if (!steps.empty() && steps.back().stamp != robot.last) {
      const bool is_back = robot.is_silent && robot.last != UtcTime{};
      robot = {.last = steps.back().stamp, .stepped_at = now, .is_silent = false};
      if (is_back) changes.push_back({.robot = id, .is_silent = false});
    } else if (!robot.is_silent && now - robot.stepped_at >= silent_) {
      robot.is_silent = true;
      changes.push_back({.robot = id, .is_silent = true});
    }
  }
  return changes;
}

}  // namespace swarm::launcher
