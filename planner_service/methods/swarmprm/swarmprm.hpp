// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "planner_service/methods/swarmprm/swarmprm_options.hpp"
#include "planner_service/stage_timer.hpp"
#include "swarmflow/core/random.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/planning/plan_request.hpp"
#include "swarmflow/planning/plan_result.hpp"
#include "swarmflow/planning/roadmap.hpp"

namespace swarm::planner {

/// ROADMAPCONSTRUCTION of SwarmPRM, Alg. 1. The first nodes are the start components of the
/// request, the next its goal components.
Roadmap make_roadmap(const PlanRequest& request, const SwarmPrmOptions& options, Rng& rng);

/// Random numbers and stage times of a plan while it is made.
struct SwarmPrmRun {
  Rng& rng;
  StageTimer& stage;  ///< runs since the roadmap was begun
};

/// SwarmPRM, Alg. 2, lines 3–7, on a roadmap of the request: shortest routes, transport problem,
/// smoothing; with a density cap min-cost flow instead. kInfeasible names the components that no
/// route joins, or those denser than the cap, and the parameters to loosen.
Result<PlanResult> plan_on_roadmap(Roadmap roadmap, const PlanRequest& request,
                                   const SwarmPrmOptions& options, const SwarmPrmRun& run);

}  // namespace swarm::planner
