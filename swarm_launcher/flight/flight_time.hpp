// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// The present time on both clocks.
struct FlightTime {
  SteadyTime steady;
  UtcTime utc;
};

}  // namespace swarm::launcher
