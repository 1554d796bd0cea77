// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

#include "swarmflow/core/time.hpp"

namespace swarm {

/// The machine's wall clock. It may be set forward or back at any moment (NTP, a user), so it is
/// read only to anchor utc_now() and to interpret stamps of the kernel.
inline UtcTime wall_clock_now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

/// UTC minus the steady clock [ns], for this process: read from the wall clock at the first use,
/// and replaced by that of the run when the process joins one (swarm_core/app/run_clock.hpp).
inline std::atomic<std::int64_t>& utc_offset_ns() {
  static std::atomic<std::int64_t> offset =
      (wall_clock_now().time_since_epoch() - std::chrono::steady_clock::now().time_since_epoch())
          .count();
  return offset;
}

/// The UTC time by the process's anchored clock, for stamps: it advances with the steady clock, so
/// that a step of the wall clock changes no order and no age. All processes of a run on one machine
/// agree on it; those of other machines to the delay of a message. Only the outermost code of a
/// program (its main loop and its input validation) reads it; all other code gets the time as a
/// parameter, so that tests and the simulator control it. Thread-safe.
inline UtcTime utc_now() {
  return UtcTime(std::chrono::steady_clock::now().time_since_epoch() +
                 Duration(utc_offset_ns().load(std::memory_order_relaxed)));
}

}  // namespace swarm
