// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "swarmflow/planning/plan_result.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/cvar.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::planner {

/// By how much a plan breaks (11g), where it does so most: of the mixture itself, at the times at
/// which ROVER keeps the limit, that is the start, the end of each step, and `between` times evenly
/// spread over it. Below 1e-6 m, what a row's margin leaves to rounding, counts as kept. A plan
/// that was softened breaks it where the swarm already does.
PlanExcess excess_of(const FlowPlan& plan, const World& world, const RiskLimit& risk,
                     std::size_t between);

}  // namespace swarm::planner
