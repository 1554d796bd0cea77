// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "swarmflow/core/random.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::planner {

/// What to plan: the flow of a swarm from one mixture to another. Refers to objects of the caller,
/// which outlive the call but not more: a method that needs them later copies them.
struct PlanRequest {
  const World& world;    ///< bounds and obstacles as they are now [m]
  const Mixture& start;  ///< where the swarm is; its components are the sources of the plan
  const Mixture& goal;   ///< where it shall be; its components are the sinks of the plan
};

/// Tells the time for statistics. Plans do not depend on it.
using StageClock = std::function<SteadyTime()>;

/// What a method may use while it plans.
struct PlanContext {
  Rng& rng;          ///< the only source of chance: the same state gives the same plan
  StageClock clock;  ///< for PlanStats
};

}  // namespace swarm::planner
