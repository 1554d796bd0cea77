// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/random.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::planner {

/// The input of a planning method: the flow of a swarm from one mixture to another is wanted.
/// Refers to objects of the caller, valid during the call: a method that needs them later copies
/// them.
struct PlanRequest {
  /// Bounds and obstacles as they are now; an obstacle that moves may occur at several positions,
  /// those it has until the next plan. Includes bodies of dead robots where a plan around them is
  /// tried.
  const World& world;
  const Mixture& start;  ///< where the swarm is; component i is to be source i of the plan
  const Mixture& goal;   ///< where it is to be; the means of its components are those of the sinks
};

/// Returns the present time, for statistics; plans must not depend on it. A test passes its own.
using StageClock = std::function<SteadyTime()>;

/// What a method may use while it plans.
struct PlanContext {
  Rng& rng;          ///< the only source of randomness: the same state gives the same plan
  StageClock clock;  ///< for the times in PlanStats; not empty
};

}  // namespace swarm::planner
