// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "planner_service/flow/density_cap.hpp"
#include "planner_service/flow/route.hpp"
#include "planner_service/roadmap/edge_check.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/planning/roadmap.hpp"

namespace swarm::planner {

/// The routes of a transport under a static density cap.
struct CappedFlow {
  std::vector<Route> routes;  ///< several may join the same two components
  double cost_m = 0.0;        ///< Σ mass · W₂ length
};

/// The transport with an upper limit on the density                             [SwarmPRM, sec.
/// V-A]
///
///   min Σ_(u,v) f_uv W₂(u, v)   s.t.  flow conserved,  flow through v ≤ 2π ρ √det Σ_v / N
///
/// over the arcs of the roadmap, by min-cost flow on nodes split in two, to the exactness of
/// min_cost_flow(). Every node counts, start and goal components with what starts and ends there.
/// The capacity is for all times together: mass that passes later counts as well. It bounds the
/// density of each Gaussian alone; neighbours overlap, so a plan is to be checked
/// (plan_density.hpp).
///
/// Nodes 0 … starts − 1 of the roadmap are the start components, the next ones the goal components.
/// Edges the solution uses are proven to kPlanTolerance_m; one that fails is closed in the roadmap,
/// and the search starts over. kInfeasible names the component that is itself too dense, or the
/// share of the swarm that fits and the ρ that all of it would need. \pre supplies and demands are
/// positive and each sum to 1.
Result<CappedFlow> capped_flow(Roadmap& roadmap, std::span<const double> supplies,
                               std::span<const double> demands, const DensityCap& cap,
                               EdgeChecker& checker);

}  // namespace swarm::planner
