// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "planner_service/planner.hpp"

/// Whether robots can fly a plan: its density and speed against the limits of their bodies.
namespace swarm::planner {

/// Radius of the discs in which densities are compared with what fits [m]: ten robots or more.
inline constexpr double kDisc_m = 2.0;

/// The densest disc of a plan, looked for every 2 s of it.
DensityPeak densest_disc_of(const FlowPlan& plan, double robots);

/// `planned density infeasible: 8.4 robots/m2 at (91.2, 50.3) m, t = 63 s; at most 2.7 fit`
std::string infeasible_density(const DensityPeak& densest, const SwarmLimits& limits);

/// Measures the densest disc of a plan that robots keep in time (SwarmPRM, ROVER) and adds warnings
/// `density-infeasible` and `speed-infeasible` where bodies cannot follow it. Nothing where limits
/// are not known.
void check_limits(PlanResult& result, const PlannerOptions& options);

}  // namespace swarm::planner
