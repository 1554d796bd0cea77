// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace swarm {

using Duration = std::chrono::nanoseconds;

/// Receiver-local clock for ages, time-outs and control periods; never jumps.
using SteadyTime = std::chrono::steady_clock::time_point;

/// UTC, for what crosses processes: stamps in messages and black boxes.
using UtcTime = std::chrono::sys_time<std::chrono::nanoseconds>;

/// Seconds since the planner's t0.
using MissionTime = std::chrono::duration<double>;

inline double to_seconds(Duration d) { return std::chrono::duration<double>(d).count(); }

inline Duration from_seconds(double s) {
  return std::chrono::round<Duration>(std::chrono::duration<double>(s));
}

}  // namespace swarm
