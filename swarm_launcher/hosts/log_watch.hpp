// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// Finds the robots of this host whose logs do not grow: their processes are dead or frozen. Asks
/// for the size of each log, a few microseconds, four times a second. The time is passed in.
class LogWatch {
 public:
  /// Logs are written at least every second, at control rates of 1 Hz or more.
  static constexpr Duration kSilent = std::chrono::milliseconds(1250);
  static constexpr Duration kPeriod = std::chrono::milliseconds(250);

  LogWatch(std::filesystem::path run_dir, RobotId first, std::uint32_t robots);

  /// Most robots of one step, as the caller reads their logs.
  static constexpr std::size_t kMostAtOnce = 8;

  /// Robots whose log has not grown for kSilent, each once until it grows again, at most
  /// kMostAtOnce a step. A robot without a log is not among them.
  std::vector<RobotId> step(SteadyTime now);

 private:
  struct Log {
    std::filesystem::path file;
    std::uintmax_t bytes = 0;
    SteadyTime grew_at{};
    bool is_reported = false;
  };

  RobotId first_;
  std::vector<Log> logs_;
  SteadyTime next_look_{};
};

}  // namespace swarm::launcher
