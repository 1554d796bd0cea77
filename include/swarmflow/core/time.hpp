// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace swarm {

/// A span of time, ±292 years in steps of 1 ns.
using Duration = std::chrono::nanoseconds;

/// A time on this machine's steady clock, for ages, timeouts and control periods: it never jumps,
/// and means nothing to another machine.
using SteadyTime = std::chrono::steady_clock::time_point;

/// A UTC time, for stamps that cross processes: in messages, files and robot logs. In a run it is
/// the run's clock, which no setting of a machine's clock changes.
using UtcTime = std::chrono::sys_time<std::chrono::nanoseconds>;

/// Seconds of mission time or plan time. Mission time counts from t0, the stamp of the start
/// command; plan time τ counts from the start of a plan's clock (PlanClock) and may advance slower.
using MissionTime = std::chrono::duration<double>;

/// A span of time in seconds; exact to about 1e-16 of it.
inline double to_seconds(Duration d) { return std::chrono::duration<double>(d).count(); }

/// A span of time of `s` seconds, rounded to the nearest nanosecond.
/// \pre s is finite and within ±292 years; not checked
inline Duration from_seconds(double s) {
  return std::chrono::round<Duration>(std::chrono::duration<double>(s));
}

}  // namespace swarm
