// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/planning/density_peak.hpp"
#include "swarmflow/planning/roadmap.hpp"

namespace swarm::planner {

/// Computing times and lengths of a plan, for reports. A method fills in what it knows, the rest
/// stays 0; `nodes`, `edges`, `total_ms` and `densest` are overwritten by the planner program.
struct PlanStats {
  std::size_t nodes = 0;         ///< nodes of PlanResult::roadmap
  std::size_t edges = 0;         ///< edges of PlanResult::roadmap
  double roadmap_ms = 0.0;       ///< time for sampling, neighbour search and edge checks [ms]
  double search_ms = 0.0;        ///< time for shortest routes, and the check of those in use [ms]
  double transport_ms = 0.0;     ///< time for the transport problem [SwarmPRM, eq. 13] [ms]
  double smoothing_ms = 0.0;     ///< time for shortening routes [ms]
  double total_ms = 0.0;         ///< time of the whole call of PlanningMethod::plan() [ms]
  double raw_mean_path_m = 0.0;  ///< Σ mass · length of the route's mean, before smoothing [m]
  double planned_mean_path_m = 0.0;  ///< the same of the returned plan [m]
  double cost_m = 0.0;               ///< Σ mass · W₂ length of the route [m]
  double cap_per_m2 = 0.0;           ///< density cap that the plan keeps [robots/m²]; 0 = none
  /// Whether the planned density is below the cap everywhere at every time of the plan, instead of
  /// only the mass through each node being bounded.
  bool cap_is_timed = false;
  DensityPeak densest{};  ///< densest disc of 2 m radius; not computed where a timed cap bounds it
};

/// A property of a plan that its user should know; published as an event.
struct PlanWarning {
  std::string code;  ///< its kind, for programs, as `cap-raised`
  std::string text;  ///< one line for people
};

/// By how much a plan breaks the risk limit, where it does so most. Only the plan for a swarm that
/// breaks the limit already may do so.
struct PlanExcess {
  double by_m = 0.0;         ///< largest CVaR_α − δ; 0 where the limit is kept [m]
  std::size_t obstacle = 0;  ///< where: index into World::obstacles() of the request's world
  MissionTime at{0};         ///< when: plan time [s]
};

/// The excess as one line: `the plan breaks the risk limit by 0.120 m at obstacle 3, t = 12.0 s`.
std::string describe(const PlanExcess& excess);

/// The output of a planning method.
struct PlanResult {
  /// The flow. FlowPlan::sources()[i] is start component i of the request (their number is
  /// checked), and every sink has the mean of a goal component.
  FlowPlan plan;
  Roadmap roadmap;                    ///< the graph that was searched, for drawings; may be empty
  PlanStats stats;                    ///< computing times and lengths
  std::vector<PlanWarning> warnings;  ///< published as events with the plan
  PlanExcess excess{};                ///< by_m = 0 for a plan that keeps its constraints
};

}  // namespace swarm::planner
