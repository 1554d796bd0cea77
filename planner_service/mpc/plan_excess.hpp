// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "swarm_core/base/time.hpp"
#include "swarm_core/plan/flow_plan.hpp"
#include "swarm_core/risk/cvar.hpp"
#include "swarm_core/world/world.hpp"

namespace swarm::planner {

/// By how much a plan breaks (11g), where it does so most.
struct PlanExcess {
  double by_m = 0.0;  ///< largest CVaR_α − ε; 0 where all are kept
  std::size_t obstacle = 0;
  MissionTime at{0};  ///< of the plan
};

/// Of the mixture itself, at the times at which ROVER keeps the limit: the start, the end of each
/// step, and `between` times evenly spread over it. Below 1e-6 m, what a row's margin leaves to
/// rounding, counts as kept. A plan that was softened breaks it where the swarm already does.
PlanExcess excess_of(const FlowPlan& plan, const World& world, const RiskLimit& risk,
                     std::size_t between);

std::string describe(const PlanExcess& excess);

}  // namespace swarm::planner
