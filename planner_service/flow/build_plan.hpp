// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "planner_service/flow/route.hpp"
#include "swarmflow/core/flow_plan.hpp"

namespace swarm::planner {

/// The flow of the given routes. Every start component is one source and every goal component one
/// sink, shared by its routes: FlowPlan::sources()[i] is start component i, sinks()[j] goal
/// component j. In between each route has nodes of its own.
///
/// Legs take leg_duration_s(), the first and the last of a route end_leg_duration_s(). All mass of
/// a sink arrives when its slowest route does: the others are stretched evenly in time, not left
/// waiting. \pre every component has a route; a route's waypoints start and end at its components.
Result<FlowPlan> build_plan(std::span<const Route> routes, std::size_t starts, std::size_t goals,
                            const LegSpeed& speed);

}  // namespace swarm::planner
