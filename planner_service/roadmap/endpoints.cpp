// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/endpoints.hpp"

#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace swarm::planner {
namespace {

// What would make the component keep the limit at its nearest obstacle: CVaR = −s + k σ ≤ δ gives
// the largest σ.
std::string advice(const Gaussian& g, const SignedDistance& at_mean, const RiskLimit& risk,
                   double k) {
  const double room_m = at_mean.distance_m + risk.delta_m;
  if (room_m <= 0.0) {
    return fmt::format("its mean is {:.2f} m from the obstacle: move it away", at_mean.distance_m);
  }
  const double sigma_m = std::sqrt(g.variance_along_m2(at_mean.gradient));
  return fmt::format(
      "move it away, narrow it from {:.2f} m to {:.2f} m standard deviation towards the obstacle, "
      "or "
      "raise planner.risk_alpha or planner.risk_delta_m",
      sigma_m, room_m / k);
}

}  // namespace

std::string describe_violations(const Mixture& mixture, std::string_view which, const World& world,
                                const RiskLimit& risk) {
  const double k = cvar_coefficient(risk.alpha);
  std::string lines;
  for (std::size_t i = 0; i < mixture.components().size(); ++i) {
    const Gaussian& g = mixture.components()[i].gaussian;
    const ConvexObstacle* worst = nullptr;
    double worst_cvar_m = risk.delta_m;
    for (const ConvexObstacle& obstacle : world.convex_obstacles()) {
      const double cvar_m = obstacle_cvar_m(g, obstacle.signed_distance(g.mean_m()), k);
      if (cvar_m > worst_cvar_m) {
        worst_cvar_m = cvar_m;
        worst = &obstacle;
      }
    }
    if (worst == nullptr) continue;
    lines += fmt::format(
        "{}{} component {} at ({:.1f}, {:.1f}) m is too near obstacle {}: CVaR {:.3f} m > delta "
        "{:.3f} m at alpha {}; {}",
        lines.empty() ? "" : "\n", which, i, g.mean_m().x(), g.mean_m().y(), worst->obstacle,
        worst_cvar_m, risk.delta_m, risk.alpha,
        advice(g, worst->signed_distance(g.mean_m()), risk, k));
  }
  return lines;
}

// Reports the violations of both ends in one error.
Result<void> check_endpoints(const World& world, const Mixture& start, const Mixture& goal,
                             const RiskLimit& risk) {
  std::string violations = describe_violations(start, "start", world, risk);
  const std::string at_goal = describe_violations(goal, "goal", world, risk);
  if (!violations.empty() && !at_goal.empty()) violations += '\n';
  violations += at_goal;
  if (violations.empty()) return {};
  return fail(ErrorCode::kInfeasible, std::move(violations));
}

}  // namespace swarm::planner
