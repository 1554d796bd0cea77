// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "planner_service/flow/route.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/gaussian.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/mission/body_limits.hpp"
#include "swarmflow/planning/plan_request.hpp"
#include "swarmflow/planning/plan_result.hpp"

/// Functions shared by methods that end in routes or a flow.
namespace swarm::planner {

/// How fast the legs of a plan may be: means at `speed_mps`, robots as their bodies allow, where
/// these are known.
LegSpeed leg_speed(double speed_mps, const SwarmLimits& limits);

/// The start components of a request, then its goal components: the first nodes of its roadmap.
std::vector<Gaussian> terminals_of(const PlanRequest& request);

/// The flow of routes between the components of a request, merged where they coincide.
Result<FlowPlan> flow_of(std::span<const Route> routes, const PlanRequest& request,
                         const LegSpeed& speed);

/// Σ mass · |Δμ| over the legs [m].
double mean_path_m(const FlowPlan& flow);

/// Sets lengths and cost of a plan that consists of routes. `raw` are the routes as the search gave
/// them, before smoothing.
void measure_routes(PlanStats& stats, std::span<const Route> raw, std::span<const Route> routes);

/// The same of a plan that was made as a flow.
void measure_flow(PlanStats& stats, const FlowPlan& flow);

}  // namespace swarm::planner
