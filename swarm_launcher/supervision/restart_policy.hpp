// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// When a process that ended is started again: after 0.3 s, and after twice as long with each death
/// in a row, at most 30 s. A process that ran for 20 s, a last silence not counted, was well: its
/// next death is the first again. Pure; the times are passed in.
class RestartPolicy {
 public:
  static constexpr Duration kFirstDelay = std::chrono::milliseconds(300);
  static constexpr Duration kLongestDelay = std::chrono::seconds(30);
  static constexpr Duration kWell = std::chrono::seconds(20);

  /// The process has been started, for the first time or again.
  void on_start(SteadyTime now) { started_at_ = now; }

  /// The process has ended, after a silence of `silent_for`; returns how long its restart waits.
  Duration on_exit(SteadyTime now, Duration silent_for = Duration::zero()) {
    if (now - started_at_ - silent_for >= kWell) in_a_row_ = 0;
    constexpr std::uint32_t kMostDoublings = 7;  // 38 s
    const Duration delay = kFirstDelay * (1U << std::min(in_a_row_, kMostDoublings));
    ++in_a_row_;
    return std::min(delay, kLongestDelay);
  }

  /// Deaths in a row, the last one included.
  std::uint32_t deaths_in_a_row() const { return in_a_row_; }

 private:
  SteadyTime started_at_;
  std::uint32_t in_a_row_ = 0;
};

}  // namespace swarm::launcher
