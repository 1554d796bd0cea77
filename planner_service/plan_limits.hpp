// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/mission/body_limits.hpp"
#include "swarmflow/planning/plan_result.hpp"
#include "swarmflow/planning/planning_method.hpp"

namespace swarm::planner {

/// Whether robots can follow a plan: its density and speed against the limits of their bodies.
/// Measures the densest disc of a plan that robots keep in time and adds warnings
/// `density-infeasible` and `speed-infeasible` where bodies cannot follow it. Nothing where limits
/// are not known (zeros) or the plan is a guide.
void check_limits(PlanResult& result, const PlanningTraits& traits, const SwarmLimits& limits,
                  double robots);

}  // namespace swarm::planner
