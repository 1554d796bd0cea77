// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include "swarmflow/core/time.hpp"

namespace swarm {

/// The time of the machine's clock. Only the outermost code of a program (its main loop and its
/// input validation) reads it; all other code gets the time as a parameter, so that tests and the
/// simulator control it.
inline UtcTime utc_now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

}  // namespace swarm
