// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "swarmflow/core/cvar.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/world.hpp"
#include "swarmflow/planning/plan_result.hpp"

namespace swarm::planner {

/// The largest violation of (11g) by a plan, and where it occurs: of the mixture itself, at the
/// times at which ROVER keeps the limit, that is the start, the end of each step, and `between`
/// times evenly spread over it. An excess below 1e-6 m counts as rounding. A softened plan violates
/// the limit where the swarm already does.
PlanExcess excess_of(const FlowPlan& plan, const World& world, const RiskLimit& risk,
                     std::size_t between);

}  // namespace swarm::planner
