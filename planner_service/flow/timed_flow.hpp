// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "planner_service/flow/density_cap.hpp"
#include "planner_service/flow/route.hpp"
#include "planner_service/roadmap/edge_check.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/planning/roadmap.hpp"

namespace swarm::planner {

/// Options of timed_flow().
struct TimedFlowOptions {
  LegSpeed speed{};
  double step_s = 0.0;            ///< grid of times; 0 for half of the median leg
  double detour = 1.05;           ///< legs on longer paths, by this factor, are left out
  double delay_cost_mps = 0.1;    ///< metres of detour that a second of delay is worth
  double stretch_max = 8.0;       ///< latest end, in free-flow times
  std::uint32_t rounds_max = 40;  ///< of solving, checking the density and lowering capacities
  double sample_s = 0.5;          ///< the density is checked this often
};

/// A plan under a density cap at every time, with numbers for reports.
struct TimedFlow {
  FlowPlan plan;
  std::vector<bool> is_end;  ///< which of its nodes are start and goal components
  double cost_m = 0.0;       ///< Σ mass · W₂ length
  double step_s = 0.0;
  double free_flow_s = 0.0;  ///< earliest arrival of all mass on this grid without a cap
  double max_density_per_m2 = 0.0;
  std::uint32_t rounds = 0;
  std::size_t network_arcs = 0;
};

/// The transport with an upper limit on the density at every time: min-cost flow on the roadmap
/// unrolled over time (timed_network.hpp), so that groups pass one after the other where they do
/// not fit at once; waves leave a start component while the rest of it waits there.
///
/// Capacities of nodes bound single Gaussians; neighbours overlap. So the plan's density is sampled
/// (plan_density.hpp), the capacity of nodes beside a peak above the cap lowered, and the flow
/// solved again, until no sample is above. When lowered capacities leave too little room the
/// horizon grows. Everything is bounded: rounds, horizon, network.
///
/// The plan's sources()[i] is start component i and sinks()[j] goal component j. kInfeasible names
/// the component that is too dense by itself, or the share of the swarm that fits. Conventions for
/// the roadmap and \pre as in capped_flow().
Result<TimedFlow> timed_flow(const Roadmap& roadmap, std::span<const double> supplies,
                             std::span<const double> demands, const DensityCap& cap,
                             const TimedFlowOptions& options, EdgeChecker& checker);

}  // namespace swarm::planner
