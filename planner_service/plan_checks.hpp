// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/random.hpp"
#include "swarmflow/core/world.hpp"

/// Checks of a plan against its guarantees, from the plan alone, independent of the planner's own
/// checks. For reports and tests.
namespace swarm::planner {

/// Largest CVaR of a plan over 201 points of every leg [m].
double planned_max_cvar_m(const FlowPlan& plan, const World& world, double alpha);

/// The same of the mixture as a whole, ROVER's (11g), at the times of all nodes and nine times
/// between each two of them [m].
double planned_max_mixture_cvar_m(const FlowPlan& plan, const World& world, double alpha);

/// The guarantee in numbers of robots, for reports: the largest share of the flow's mixture inside
/// obstacles, over its whole time, from `samples` points drawn from it. A robot rides a point of
/// its own and is shrunk towards the mean there, so this is a share of the plan, not of robots.
double planned_obstacle_share(const FlowPlan& plan, const World& world, std::size_t samples,
                              Rng& rng);

}  // namespace swarm::planner
