// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>

#include "swarmflow/core/time.hpp"

/// Times that launcher and robots must agree on.
namespace swarm {

/// Without a message for this long, the launcher reports a process as silent that publishes
/// `rate_hz` times a second: 3 s, and at least three periods.
inline Duration reported_silence(double rate_hz) {
  return std::max<Duration>(std::chrono::seconds(3), from_seconds(3.0 / rate_hz));
}

/// When its last status is this old, the launcher lists a robot as late in its beats: a quarter of
/// a period beyond the next one, and at least 0.2 s.
inline Duration late_status(double rate_hz) {
  return from_seconds(std::max(1.25 / rate_hz, 1.0 / rate_hz + 0.2));
}

/// Rate of the launcher's beats.
inline constexpr double kBeatHz = 2.0;

}  // namespace swarm
