// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/time.hpp"

namespace swarm {

/// What the machine's clock says; for those by the input validation alone, everyone else is given the time.
inline UtcTime utc_now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

}  // namespace swarm
