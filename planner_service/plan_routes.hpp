// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "planner_service/planner.hpp"
#include "planner_service/stage_timer.hpp"
#include "planner_service/transport/route.hpp"

namespace swarm::planner {

/// How fast the legs of a plan may be by these options.
LegSpeed leg_speed(const PlannerOptions& options);

/// Σ mass · |Δμ| over the legs [m].
double mean_path_m(const FlowPlan& flow);

/// The result of a method that ends in routes: their flow, merged where they coincide, and what
/// they cost, into `result`, which holds the roadmap and the times so far. `raw` are the routes as
/// the roadmap gave them.
Result<PlanResult> plan_of_routes(std::span<const Route> raw, std::span<const Route> routes,
                                  const PlanRequest& request, const LegSpeed& speed,
                                  PlanResult result, StageTimer& whole);

/// The same of a method that ends in a flow.
PlanResult plan_of_flow(FlowPlan flow, PlanResult result, StageTimer& whole);

}  // namespace swarm::planner
