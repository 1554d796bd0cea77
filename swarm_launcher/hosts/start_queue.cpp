// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/hosts/start_queue.hpp"

#include <algorithm>

namespace swarm::launcher {

bool StartQueue::on_exit(std::uint32_t robot, SteadyTime now) {
  RestartPolicy& restarts = restarts_[robot];
  const Duration delay = restarts.on_exit(now);
  if (restarts.deaths_in_a_row() > respawns_) return false;
  waiting_.push_back({.robot = robot, .due = now + delay});
  return true;
}

std::optional<std::uint32_t> StartQueue::next(SteadyTime now) {
  if (now < next_start_) return std::nullopt;
  const auto due = std::ranges::find_if(waiting_, [now](const Waiting& w) { return w.due <= now; });
  if (due == waiting_.end()) return std::nullopt;
  const std::uint32_t robot = due->robot;
  waiting_.erase(due);
  next_start_ = now + kStartEvery;
  restarts_[robot].on_start(now);
  return robot;
}

}  // namespace swarm::launcher
