// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/plan_checks.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "swarm_core/gmm/wasserstein.hpp"
#include "swarm_core/risk/mixture_cvar.hpp"
#include "swarmflow/core/cvar.hpp"

namespace swarm::planner {
namespace {

constexpr int kFineGrid = 200;

}  // namespace

// Samples legs densely instead of using the planner's proofs, so that it can find their errors.
double planned_max_cvar_m(const FlowPlan& plan, const World& world, double alpha) {
  const double k = cvar_coefficient(alpha);
  double worst_m = -std::numeric_limits<double>::infinity();
  for (const PlanNode& node : plan.nodes()) {
    worst_m = std::max(worst_m, max_cvar_m(node.gaussian, world, k));
  }
  for (const PlanLeg& leg : plan.legs()) {
    const Geodesic geodesic(plan.nodes()[leg.from].gaussian, plan.nodes()[leg.to].gaussian);
    for (int i = 1; i < kFineGrid; ++i) {
      const Gaussian g = geodesic.at(static_cast<double>(i) / kFineGrid);
      worst_m = std::max(worst_m, max_cvar_m(g, world, k));
    }
  }
  return worst_m;
}

// Ten equal parts of each interval between the distinct times of nodes.
double planned_max_mixture_cvar_m(const FlowPlan& plan, const World& world, double alpha) {
  constexpr int kBetween = 10;
  std::vector<MissionTime> times;
  for (const PlanNode& node : plan.nodes()) times.push_back(node.time);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  double worst_m = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < times.size(); ++i) {
    const MissionTime next = times[std::min(i + 1, times.size() - 1)];
    for (int k = 0; k < kBetween; ++k) {
      const MissionTime t = times[i] + (next - times[i]) * (static_cast<double>(k) / kBetween);
      worst_m = std::max(worst_m, max_mixture_cvar_m(plan.mixture_at(t), world, alpha));
    }
  }
  return worst_m;
}

// Components by stratified draw, points within a component at random: x = μ + L z with Σ = LLᵀ.
double planned_obstacle_share(const FlowPlan& plan, const World& world, std::size_t samples,
                              Rng& rng) {
  constexpr std::size_t kTimes = 100;
  const std::size_t points = std::max<std::size_t>(1, samples / kTimes);
  double worst = 0.0;
  for (std::size_t i = 0; i < kTimes; ++i) {
    const double share = static_cast<double>(i) / (kTimes - 1);
    const Mixture mixture = plan.mixture_at(share * plan.duration());
    std::size_t inside = 0;
    for (std::size_t p = 0; p < points; ++p) {
      const std::size_t component =
          mixture.component_at((static_cast<double>(p) + 0.5) / static_cast<double>(points));
      const Gaussian& g = mixture.components()[component].gaussian;
      const double u = standard_normal(rng);
      const Vec2 z(u, standard_normal(rng));
      inside += world.is_clear(g.mean_m() + cholesky_lower(g.covariance_m2()) * z, 0.0) ? 0U : 1U;
    }
    worst = std::max(worst, static_cast<double>(inside) / static_cast<double>(points));
  }
  return worst;
}

}  // namespace swarm::planner
