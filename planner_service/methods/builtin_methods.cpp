// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/builtin_methods.hpp"

#include <string>
#include <utility>

#include "planner_service/methods/adoc/adoc_method.hpp"
#include "planner_service/methods/crops/crops_method.hpp"
#include "planner_service/methods/rover/rover_method.hpp"
#include "planner_service/methods/swarmprm/swarmprm_method.hpp"
#include "swarmflow/planning/run_planner.hpp"

namespace swarm::planner {

namespace {

// Registry entry of a method class, which has static keys() and make().
template <class Method>
PlanningEntry entry(std::string name, std::string doc) {
  return {.spec = {.name = std::move(name), .doc = std::move(doc), .options = Method::keys()},
          .make = &Method::make};
}

}  // namespace

void register_builtin_methods(PlanningRegistry& registry) {
  registry.add(entry<SwarmPrmMethod>("swarmprm",
                                     "Gaussian roadmap, transport problem, smoothing; every "
                                     "Gaussian keeps the risk limit [SwarmPRM]"));
  registry.add(entry<RoverMethod>("rover",
                                  "Model predictive control on a collocation set, planned again in "
                                  "motion; the mixture keeps the risk limit [ROVER]"));
  registry.add(entry<CropsMethod>("crops",
                                  "A guide on a roadmap of points that prefers open space and "
                                  "avoids congestion [CRoPS]"));
  registry.add(entry<AdocMethod>("adoc",
                                 "The papers' baseline: overlap with obstacles is penalised, no "
                                 "guarantee about risk"));
}

PlanningRegistry builtin_planning() {
  PlanningRegistry registry;
  register_builtin_methods(registry);
  return registry;
}

}  // namespace swarm::planner
