// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/late_robots.hpp"

#include <algorithm>
#include <chrono>

#include "swarm_core/mission/supervision_times.hpp"

namespace swarm::launcher {
namespace {

constexpr Duration kOwnGap = std::chrono::seconds(1);

}  // namespace

LateRobots::LateRobots(std::uint32_t robots, double status_hz)
    : from_(late_status(status_hz)),
      to_(reported_silence(status_hz) + std::chrono::seconds(3)),
      last_(robots) {}

void LateRobots::on_status(RobotId robot, const Vec2& position_m, SteadyTime measured,
                           SteadyTime now) {
  last_.at(robot.value()) = {
      .is_known = true, .received = now, .measured = measured, .position_m = position_m};
}

void LateRobots::list(SteadyTime now, link::LauncherBeat& beat) {
  const bool was_suspended = listed_at_ && now - *listed_at_ > kOwnGap;
  listed_at_ = now;
  if (was_suspended) {
    silent_until_ = now + from_;
    for (Last& last : last_) last.received = now;  // silences count from now on
  }
  late_.clear();
  for (std::uint32_t i = 0; i < last_.size() && now >= silent_until_; ++i) {
    const Last& last = last_[i];
    const Duration age = now - last.measured;
    if (!last.is_known || age <= from_ || now - last.received > to_) continue;
    const auto age_ms = std::chrono::ceil<std::chrono::milliseconds>(age).count();
    late_.push_back({.robot = i,
                     .age_ms = static_cast<std::uint32_t>(age_ms),
                     .x_m = last.position_m.x(),
                     .y_m = last.position_m.y()});
  }
  next_ = late_.size() > link::LauncherBeat::kMaxLate ? next_ % late_.size() : 0;
  std::ranges::rotate(late_, late_.begin() + static_cast<std::ptrdiff_t>(next_));
  next_ += link::LauncherBeat::kMaxLate;
  link::set_late(beat, late_);
  beat.lists_all_late = beat.lists_all_late && now >= silent_until_;
}

}  // namespace swarm::launcher
