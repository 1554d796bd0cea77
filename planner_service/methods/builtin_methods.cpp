// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/builtin_methods.hpp"

#include "planner_service/methods/adoc/adoc_method.hpp"
#include "planner_service/methods/crops/crops_method.hpp"
#include "planner_service/methods/rover/rover_method.hpp"
#include "planner_service/methods/swarmprm/swarmprm_method.hpp"

namespace swarm::planner {

void register_builtin_methods(PlanningRegistry& registry) {
  registry.add("swarmprm",
               "Gaussian roadmap, transport problem, smoothing; every Gaussian keeps "
               "the risk limit",
               &SwarmPrmMethod::make);
  registry.add("rover",
               "model predictive control on a collocation set, planned anew in flight; "
               "the mixture keeps the risk limit",
               &RoverMethod::make);
  registry.add("crops",
               "a guide on a roadmap of points that prefers open space and avoids "
               "congestion",
               &CropsMethod::make);
  registry.add("adoc",
               "the papers' baseline: overlap with obstacles is penalised, no promise "
               "about risk",
               &AdocMethod::make);
}

}  // namespace swarm::planner
