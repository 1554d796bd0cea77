// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/hosts/step_watch.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace swarm::launcher {
namespace {

constexpr Duration kOwnGap = std::chrono::seconds(2);

}  // namespace

std::vector<StepWatch::Change> StepWatch::step(SteadyTime now) {
  std::vector<Change> changes;
  if (now < next_look_) return changes;
  next_look_ = now + kPeriod;
  // The whole host was suspended, and its robots with it.
  if (now - std::exchange(looked_at_, now) > kOwnGap) {
    for (Robot& robot : robots_) robot.stepped_at = now;
  }
  for (std::uint32_t i = 0; i < robots_.size(); ++i) {
    Robot& robot = robots_[i];
    const RobotId id(first_.value() + i);
    const auto steps = steps_.last(id);
    if (!steps.empty() && steps.back().stamp != robot.last) {
      robot.last = steps.back().stamp;
      robot.stepped_at = now;
      if (std::exchange(robot.is_silent, false)) robot.began_at = now;
      if (!robot.is_reported || now - robot.began_at < kBack) continue;
      robot.is_reported = false;
      changes.push_back({.robot = id, .is_silent = false});
    } else if (!robot.is_silent && now - robot.stepped_at >= silent_) {
      robot.is_silent = robot.is_reported = true;
      changes.push_back({.robot = id, .is_silent = true});
    }
  }
  return changes;
}

std::vector<RobotId> StepWatch::hung(SteadyTime now) const {
  std::vector<RobotId> hung;
  for (std::uint32_t i = 0; i < robots_.size(); ++i) {
    const Robot& robot = robots_[i];
    if (robot.is_silent && robot.is_reported && now - robot.stepped_at >= kHung) {
      hung.emplace_back(first_.value() + i);
    }
  }
  return hung;
}

}  // namespace swarm::launcher
