// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "planner_service/flow/route.hpp"
#include "planner_service/roadmap/edge_check.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::planner {

/// Shortens a route by `tries` random shortcuts: two points of it, at random W₂ lengths, are joined
/// by the geodesic between them where that keeps the risk limit and is shorter. The ends stay.
void take_shortcuts(Waypoints& waypoints, std::uint32_t tries, EdgeChecker& checker, Rng& rng);

/// Leaves out every waypoint whose neighbours can be joined directly.
void drop_superfluous(Waypoints& waypoints, EdgeChecker& checker);

}  // namespace swarm::planner
