// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "swarm_link/gate/wire_limits.hpp"

/// Number checks used by the content checks.
namespace swarm::link {

/// Whether none of the numbers is NaN or infinite.
template <class... Numbers>
bool all_finite(Numbers... numbers) {
  return (std::isfinite(numbers) && ...);
}

/// Whether a point lies inside the bounds plus slack. \pre finite coordinates
inline bool is_inside(double x_m, double y_m, const WireLimits& limits) {
  return limits.bounds_m.distance_m({x_m, y_m}) <= limits.bounds_slack_m;
}

}  // namespace swarm::link
