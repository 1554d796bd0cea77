// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/late_robots.hpp"

#include <algorithm>
#include <chrono>

#include "swarm_core/mission/supervision_times.hpp"

namespace swarm::launcher {

LateRobots::LateRobots(std::uint32_t robots, double status_hz)
    : from_(late_status(status_hz)),
      to_(reported_silence(status_hz) + std::chrono::seconds(3)),
      last_(robots) {}

void LateRobots::on_status(RobotId robot, const Vec2& position_m, SteadyTime measured,
                           SteadyTime now) {
  last_.at(robot.value()) = {
      .is_known = true, .received = now, .measured = measured, .position_m = position_m};
}

std::span<const link::LateRobot> LateRobots::at(SteadyTime now) {
  late_.clear();
  for (std::uint32_t i = 0; i < last_.size(); ++i) {
    const Last& last = last_[i];
    const Duration silence = now - last.received;
    if (!last.is_known || silence <= from_ || silence > to_) continue;
    // A stamp is at most a few seconds old, so that its age fits.
    const Duration age = std::clamp<Duration>(now - last.measured, Duration::zero(), 2 * to_);
    const auto age_ms = std::chrono::ceil<std::chrono::milliseconds>(age).count();
    late_.push_back({.robot = i,
                     .age_ms = static_cast<std::uint32_t>(age_ms),
                     .x_m = last.position_m.x(),
                     .y_m = last.position_m.y()});
  }
  std::ranges::sort(late_, {}, &link::LateRobot::age_ms);
  return late_;
}

}  // namespace swarm::launcher
