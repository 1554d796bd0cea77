// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "swarm_link/gate/wire_limits.hpp"

/// Tests that the content checks share.
namespace swarm::link {

template <class... Numbers>
bool all_finite(Numbers... numbers) {
  return (std::isfinite(numbers) && ...);
}

inline bool is_inside(double x_m, double y_m, const WireLimits& limits) {
  return limits.bounds_m.distance_m({x_m, y_m}) <= limits.bounds_slack_m;
}

}  // namespace swarm::link
