// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/hosts/log_watch.hpp"

#include <system_error>

#include "swarm_core/robot_log/robot_log_file.hpp"

namespace swarm::launcher {

LogWatch::LogWatch(std::filesystem::path run_dir, RobotId first, std::uint32_t robots)
    : first_(first) {
  for (std::uint32_t i = 0; i < robots; ++i) {
    logs_.push_back({.file = robot_log::file_of(run_dir, RobotId(first.value() + i))});
  }
}

std::vector<RobotId> LogWatch::step(SteadyTime now) {
  std::vector<RobotId> silent;
  if (now < next_look_) return silent;
  next_look_ = now + kPeriod;
  for (std::size_t i = 0; i < logs_.size(); ++i) {
    Log& log = logs_[i];
    std::error_code none;
    const std::uintmax_t bytes = std::filesystem::file_size(log.file, none);
    if (none) continue;
    if (bytes != log.bytes) {
      log.bytes = bytes;
      log.grew_at = now;
      log.is_reported = false;
    } else if (!log.is_reported && now - log.grew_at >= kSilent && silent.size() < kMostAtOnce) {
      log.is_reported = true;
      silent.emplace_back(first_.value() + static_cast<std::uint32_t>(i));
    }
  }
  return silent;
}

}  // namespace swarm::launcher
