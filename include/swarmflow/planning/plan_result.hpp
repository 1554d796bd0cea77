// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "swarmflow/planning/density_peak.hpp"
#include "swarmflow/planning/roadmap.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/core/flow_plan.hpp"

namespace swarm::planner {

/// What a plan cost and how long its paths are, for reports. A method fills in what it knows;
/// `nodes`, `edges`, `total_ms` and `densest` are filled in by Planner.
struct PlanStats {
  std::size_t nodes = 0;      ///< of PlanResult::roadmap
  std::size_t edges = 0;      ///< of PlanResult::roadmap
  double roadmap_ms = 0.0;    ///< sampling, neighbours, edge checks
  double search_ms = 0.0;     ///< shortest routes, and the proof of those taken
  double transport_ms = 0.0;  ///< LP (13)
  double smoothing_ms = 0.0;
  double total_ms = 0.0;
  double raw_mean_path_m = 0.0;      ///< Σ mass · length of the route's mean, before smoothing
  double planned_mean_path_m = 0.0;  ///< the same of the published plan
  double cost_m = 0.0;               ///< Σ mass · W₂ length of the route
  double cap_per_m2 = 0.0;           ///< density cap that the plan keeps [robots/m²]; 0 = none
  bool cap_is_timed = false;         ///< no place is denser than the cap at any time of the plan
  DensityPeak densest{};             ///< disc of 2 m, where a timed cap does not bound it
};

/// Something about a plan that its user should know, in one line.
struct PlanWarning {
  std::string code;  ///< for programs, as `cap-raised`
  std::string text;  ///< for people
};

/// By how much a plan breaks the risk limit, where it does so most. Only the plan of a swarm that
/// breaks the limit already may do so.
struct PlanExcess {
  double by_m = 0.0;         ///< largest CVaR_α − δ; 0 where the limit is kept
  std::size_t obstacle = 0;  ///< of the mission's world
  MissionTime at{0};         ///< of the plan
};

/// `the plan breaks the risk limit by 0.120 m at obstacle 3, t = 12.0 s`
std::string describe(const PlanExcess& excess);

/// What a planning method returns.
struct PlanResult {
  /// FlowPlan::sources()[i] is start component i of the request. Sinks have the means of its goal
  /// components.
  FlowPlan plan;
  Roadmap roadmap;  ///< what was searched, for drawings; may be empty
  PlanStats stats;
  std::vector<PlanWarning> warnings;
  PlanExcess excess{};
};

}  // namespace swarm::planner
