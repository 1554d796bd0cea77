// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "planner_service/planner.hpp"

namespace swarm::planner {

/// SwarmPRM, Alg. 2, lines 1–7: roadmap, shortest routes, transport problem, smoothing. Errors as
/// of Planner::plan().
Result<PlanResult> plan_swarmprm(const PlanRequest& request, const PlannerOptions& options,
                                 Rng& rng, const StageClock& clock);

}  // namespace swarm::planner
