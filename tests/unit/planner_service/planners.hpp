// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

#include "planner_service/methods/builtin_methods.hpp"
#include "planner_service/methods/swarmprm/swarmprm_method.hpp"
#include "planner_service/planner.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm::test {

inline SteadyTime no_time() { return {}; }

/// The planner of a mission, with the built-in methods to choose from.
inline planner::Planner planner_of(const Mission& mission,
                                   planner::PlanningUse use = planner::PlanningUse::kInFlight) {
  planner::PlanningRegistry registry;
  planner::register_builtin_methods(registry);
  return planner::Planner::make(registry, mission, use).value();
}

/// SwarmPRM with options of the test's own; robots' bodies are limited by `options.limits`.
inline planner::Planner swarmprm_planner(const planner::SwarmPrmOptions& options = {}) {
  return {std::make_unique<planner::SwarmPrmMethod>(options), options.limits,
          options.density.robots};
}

/// One plan by SwarmPRM, on a roadmap that is not kept.
inline Result<planner::PlanResult> plan_once(const planner::PlanRequest& request,
                                             planner::SwarmPrmOptions options, Rng& rng,
                                             planner::StageClock clock = &no_time) {
  options.keeps_roadmap = false;
  return swarmprm_planner(options).plan(request, {rng, std::move(clock)});
}

/// One plan of a mission by its own method.
inline Result<planner::PlanResult> plan_mission(const Mission& mission, Rng& rng) {
  return planner_of(mission, planner::PlanningUse::kOnePlan)
      .plan({mission.world, mission.start, mission.goal}, {rng, &no_time});
}

/// The options of SwarmPRM that a mission asks for.
inline planner::SwarmPrmOptions swarmprm_options_of(const Mission& mission) {
  return planner::swarmprm_options(
      {.mission = mission,
       .limits = swarm_limits(mission.robots, mission.safety, mission.control)});
}

}  // namespace swarm::test
