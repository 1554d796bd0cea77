// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "planner_service/roadmap/roadmap.hpp"
#include "planner_service/roadmap/sampler.hpp"
#include "swarm_core/base/random.hpp"
#include "swarm_core/base/time.hpp"
#include "swarm_core/gmm/mixture.hpp"
#include "swarm_core/mission/mission.hpp"
#include "swarm_core/plan/flow_plan.hpp"
#include "swarm_core/risk/cvar.hpp"
#include "swarm_core/world/world.hpp"

namespace swarm::planner {

struct PlannerOptions {
  std::size_t samples = 500;          ///< n of Alg. 1
  double connection_radius_m = 20.0;  ///< r of Alg. 1, in W₂
  RiskLimit risk;
  SamplerOptions sampler;
  std::uint32_t shortcuts =
      200;                  ///< smoothing tries per route; 0 leaves the roadmap's routes alone
  double speed_mps = 1.25;  ///< of the means along a route
};

/// The options a mission asks for.
PlannerOptions planner_options(const PlannerSpec& spec);

/// What to plan; refers to the caller's objects for the duration of the call.
struct PlanRequest {
  const World& world;
  const Mixture& start;
  const Mixture& goal;
};

struct PlanStats {
  std::size_t nodes = 0;
  std::size_t edges = 0;
  double roadmap_ms = 0.0;    ///< sampling, neighbours, edge checks
  double search_ms = 0.0;     ///< shortest routes, and the proof of those taken
  double transport_ms = 0.0;  ///< LP (13)
  double smoothing_ms = 0.0;
  double total_ms = 0.0;
  double raw_mean_path_m = 0.0;      ///< Σ mass · length of the route's mean, before smoothing
  double planned_mean_path_m = 0.0;  ///< the same of the published plan
  double cost_m = 0.0;               ///< Σ mass · W₂ length of the route
};

struct PlanResult {
  FlowPlan plan;
  Roadmap roadmap;  ///< nodes: start components, goal components, samples
  PlanStats stats;
};

/// Tells the time for PlanStats; the planner itself does not depend on it.
using StageClock = std::function<SteadyTime()>;

/// SwarmPRM, Alg. 2, lines 1–7: roadmap, shortest routes, transport problem, smoothing. The same
/// request, options and generator state give the same plan.
///
/// kInfeasible says which component breaks the risk limit at which obstacle, or which components no
/// route joins, and what to loosen.
Result<PlanResult> plan(const PlanRequest& request, const PlannerOptions& options, Rng& rng,
                        const StageClock& clock);

/// Largest CVaR of a plan over 201 points of every leg [m], for reports: checks the plan anew, with
/// nothing of the planner's own edge check in it.
double planned_max_cvar_m(const FlowPlan& plan, const World& world, double alpha);

/// What the promise means in robots, for reports: the largest share of the flow's mixture inside
/// obstacles, over its whole time, from `samples` points drawn from it. A robot rides a point of
/// its own and is shrunk towards the mean there, so this is a share of the plan, not of robots.
double planned_obstacle_share(const FlowPlan& plan, const World& world, std::size_t samples,
                              Rng& rng);

}  // namespace swarm::planner
