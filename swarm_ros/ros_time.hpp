// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

#include "swarm_ros/messages.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::ros {

/// A time since the epoch of a clock as ROS writes it.
inline Time time_of(Duration since_epoch) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t ns = since_epoch.count();
  return {.sec = static_cast<std::int32_t>(ns / kSecond_ns),
          .nanosec = static_cast<std::uint32_t>(ns % kSecond_ns)};
}

inline Time time_of(UtcTime utc) { return time_of(utc.time_since_epoch()); }

/// Since the epoch of its clock.
inline Duration duration_of(const Time& time) {
  return std::chrono::seconds(time.sec) + std::chrono::nanoseconds(time.nanosec);
}

}  // namespace swarm::ros
