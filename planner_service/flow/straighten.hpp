// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "planner_service/flow/density_cap.hpp"
#include "planner_service/flow/route.hpp"
#include "planner_service/roadmap/edge_check.hpp"
#include "swarmflow/core/cvar.hpp"
#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::planner {

/// Limits and effort of straighten().
struct StraightenOptions {
  LegSpeed speed{};          ///< no leg is faster than this
  double sigma_min_m = 0.8;  ///< no Gaussian is squeezed below this
  double split_m = 5.0;      ///< legs longer than this may bend in their middle
  std::uint32_t sweeps = 12;
  /// Share of the action of a node's legs that a move has to save. A thirtieth of it makes routes
  /// 0.1 % shorter and costs twice.
  double worthwhile = 3e-3;
  double sample_s = 0.5;  ///< the density is checked this often
};

/// Pulls the routes of a timed plan straight: they join nodes of a roadmap, which lie where its
/// samples do. Lowers the action of the flow, Σ mass · W₂² / time over its legs, whose least value
/// is the straight line at an even speed [Benamou and Brenier]. All nodes of the plan stay in it
/// with their times and masses, in their order; those of start and goal components, `is_end`, also
/// stay where they are. New nodes, in the middle of legs that go around a corner, come after them.
///
/// Node after node, each moves to the W₂ mean of its neighbours, weighted by mass over time, or
/// half or a quarter of that distance, is pushed out of obstacles and squeezed beside them, and
/// stays there if that lowers the action and its legs keep the speed, the risk limit and, with all
/// others at their times, the density cap. The cap is checked by climbing from the means of those
/// legs alone, so the plan is checked once more as a whole (plan_density.hpp), and nodes beside a
/// peak above the cap go back, with neighbours they can no longer be joined to. So the result keeps
/// everything that `plan` keeps: at worst it is the same flow.
///
/// Cost: sweeps · nodes that still move · (edge checks + times · legs in sight).
FlowPlan straighten(const FlowPlan& plan, const std::vector<bool>& is_end, const World& world,
                    const RiskLimit& risk, const DensityCap& cap, const StraightenOptions& options,
                    EdgeChecker& checker);

}  // namespace swarm::planner
