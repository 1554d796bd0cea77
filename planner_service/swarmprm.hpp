// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "planner_service/planner.hpp"
#include "planner_service/stage_timer.hpp"

namespace swarm::planner {

/// The terminals of a request, the first nodes of its roadmap: start, then goal components.
std::vector<Gaussian> terminals_of(const PlanRequest& request);

/// kInfeasible when a start or goal component breaks the risk limit where it stands: which, at
/// which obstacle, and what to loosen.
Result<void> check_endpoints(const PlanRequest& request, const RiskLimit& risk);

/// ROADMAPCONSTRUCTION of SwarmPRM, Alg. 1.
Roadmap make_roadmap(const PlanRequest& request, const PlannerOptions& options, Rng& rng);

/// SwarmPRM, Alg. 2, lines 3–7, on a roadmap of the request: shortest routes, transport problem,
/// smoothing; with a density cap min-cost flow instead, whose plan is not smoothed. `whole` and
/// `stage` run since the roadmap was begun. Errors as of Planner::plan().
Result<PlanResult> plan_on_roadmap(Roadmap roadmap, const PlanRequest& request,
                                   const PlannerOptions& options, Rng& rng, StageTimer& stage,
                                   StageTimer& whole);

}  // namespace swarm::planner
