// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/plan_excess.hpp"

#include <algorithm>
#include <vector>

#include "swarm_core/risk/mixture_cvar.hpp"

namespace swarm::planner {
namespace {

// Excess below this counts as rounding.
constexpr double kKept_m = 1e-6;

// The distinct times of the nodes: ROVER's nodes lie at the ends of its steps.
std::vector<MissionTime> step_ends(const FlowPlan& plan) {
  std::vector<MissionTime> times;
  for (const PlanNode& node : plan.nodes()) times.push_back(node.time);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

}  // namespace

// Tests the mixture of the plan itself, not the rows of the linear programs, so that it also finds
// errors of the linearisation.
PlanExcess excess_of(const FlowPlan& plan, const World& world, const RiskLimit& risk,
                     std::size_t between) {
  PlanExcess most{.by_m = kKept_m};
  const auto look = [&](MissionTime at) {
    const Mixture mixture = plan.mixture_at(at);
    for (const ConvexObstacle& obstacle : world.convex_obstacles()) {
      const double cvar_m =
          mixture_tail_risk(negated_distance(mixture, obstacle), risk.alpha).cvar_m;
      if (cvar_m - risk.delta_m <= most.by_m) continue;
      most = {cvar_m - risk.delta_m, obstacle.obstacle, at};
    }
  };
  const std::vector<MissionTime> ends = step_ends(plan);
  const auto parts = static_cast<double>(between + 1);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    look(ends[i]);
    if (i + 1 == ends.size()) break;
    for (std::size_t part = 1; part <= between; ++part) {
      look(ends[i] + static_cast<double>(part) / parts * (ends[i + 1] - ends[i]));
    }
  }
  if (most.by_m <= kKept_m) most.by_m = 0.0;
  return most;
}

}  // namespace swarm::planner
