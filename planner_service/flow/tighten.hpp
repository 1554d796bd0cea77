// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "planner_service/flow/route.hpp"
#include "planner_service/roadmap/edge_check.hpp"

namespace swarm::planner {

/// Resolution and effort of tighten().
struct TightenOptions {
  double spacing_m = 4.0;    ///< the route is cut into legs of about this W₂ length first
  std::uint32_t sweeps = 5;  ///< five are enough, more change less than 0.1 %
  double sigma_min_m = 0.8;  ///< no waypoint is squeezed below this
};

/// Pulls a route tight like a rubber band around the corners, which random shortcuts only approach:
/// each waypoint moves to the W₂ midpoint of its neighbours, is squeezed and pushed out of the
/// obstacles there, and stays if that is shorter and both its legs keep the risk limit. The ends
/// stay.
void tighten(Waypoints& waypoints, const World& world, const RiskLimit& risk,
             const TightenOptions& options, EdgeChecker& checker);

}  // namespace swarm::planner
