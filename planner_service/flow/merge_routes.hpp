// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "planner_service/flow/route.hpp"
#include "swarmflow/core/flow_plan.hpp"

namespace swarm::planner {

/// The flow of the given routes, in which routes that pass the same Gaussians do so together: the
/// number of Gaussians of χ(t) varies in time and is smaller                  [SwarmPRM, Remark 1]
///
/// Waypoints are the same when their Gaussians are, bit for bit, as on paths of one roadmap;
/// smoothing moves them apart. Those of two routes become one node, with their masses added, unless
/// some goal would be reached later than by build_plan(): the earlier of the two waits for the
/// other. Behind a node where routes part again, robots take a leg by its mass: the numbers that
/// leave each start and arrive at each goal are kept, the numbers from one component to another are
/// not. The robots are identical, so that only the former matter.
///
/// Times: goals are reached when their slowest route allows it. In between, the tightest path
/// between two nodes of known time is paced evenly, then the tightest of those that are left; no
/// leg is faster than `speed` allows. Without anything to merge that is build_plan(), whose
/// contract for sources and sinks and whose \pre hold. Cost: waypoints² of all routes.
Result<FlowPlan> build_merged_plan(std::span<const Route> routes, std::size_t starts,
                                   std::size_t goals, const LegSpeed& speed);

}  // namespace swarm::planner
