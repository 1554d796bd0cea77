// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/risk/mixture_cvar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "swarm_core/base/assert.hpp"
#include "swarmflow/core/cvar.hpp"

namespace swarm {
namespace {

// Most rounds of the root search; bisection alone needs 60 for double precision.
constexpr int kRounds = 100;

double density(double z) { return std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi); }

double tail(double z) { return 0.5 * std::erfc(z / std::numbers::sqrt2); }

// E[(Y − level)⁺] of one component. Far in the tail the two terms cancel to nothing: never below 0.
double excess_m(const LineComponent& c, double level_m) {
  const double z = (level_m - c.mean_m) / c.sigma_m;
  return std::max(0.0, c.sigma_m * (density(z) - z * tail(z)));
}

}  // namespace

// VARSEARCH: solves Σ ωⱼ P(Yʲ > z) = α for z by Newton's method, safeguarded by bisection in the
// bracket [low_m, high_m]. CVaR then follows in closed form.
TailRisk mixture_tail_risk(std::span<const LineComponent> components, double alpha) {
  double total = 0.0;
  for (const LineComponent& c : components) {
    SWARM_ASSERT(c.weight >= 0.0 && c.sigma_m > 0.0);
    total += c.weight;
  }
  SWARM_ASSERT(alpha > 0.0 && alpha < total);
  // The quantile of a mixture lies between those of its components.
  const double q = standard_normal_quantile(1.0 - alpha / total);
  double low_m = std::numeric_limits<double>::infinity();
  double high_m = -low_m;
  for (const LineComponent& c : components) {
    if (c.weight == 0.0) continue;
    low_m = std::min(low_m, c.mean_m + q * c.sigma_m);
    high_m = std::max(high_m, c.mean_m + q * c.sigma_m);
  }
  double var_m = 0.5 * (low_m + high_m);
  double last_step_m = high_m - low_m;
  for (int round = 0; round < kRounds; ++round) {
    double above = -alpha;  // tail probability − α, falls with var_m
    double slope = 0.0;
    for (const LineComponent& c : components) {
      const double z = (var_m - c.mean_m) / c.sigma_m;
      above += c.weight * tail(z);
      slope -= c.weight * density(z) / c.sigma_m;
    }
    // The tail probability falls with z: above α, `var_m` is below the root.
    (above > 0.0 ? low_m : high_m) = var_m;
    if (above == 0.0) break;
    // Near a narrow component Newton's steps are too long or too short: a step must stay inside the
    // bracket and be at most half as long as the one before, or it is replaced by a bisection.
    double next_m = var_m - above / slope;
    const bool good = next_m > low_m && next_m < high_m &&
                      2.0 * std::abs(next_m - var_m) <= std::abs(last_step_m);
    if (!good) next_m = 0.5 * (low_m + high_m);
    last_step_m = next_m - var_m;
    const bool settled = std::abs(last_step_m) <= 1e-14 * (1.0 + std::abs(var_m));
    var_m = next_m;
    if (settled) break;
  }
  double cvar_m = var_m;
  for (const LineComponent& c : components) cvar_m += c.weight * excess_m(c, var_m) / alpha;
  return {var_m, cvar_m};
}

// [ROVER, eq. 18]. The derivative of VaR drops out, because VaR minimises eq. 25.
void mixture_cvar_gradient(std::span<const LineComponent> components, double alpha, double var_m,
                           std::span<double> gradient_m) {
  SWARM_ASSERT(gradient_m.size() == components.size());
  for (std::size_t j = 0; j < components.size(); ++j) {
    gradient_m[j] = excess_m(components[j], var_m) / alpha;
  }
}

// As in obstacle_cvar_m(), each component is linearised at its own mean.
std::vector<LineComponent> negated_distance(const Mixture& mixture,
                                            const ConvexObstacle& obstacle) {
  std::vector<LineComponent> line;
  line.reserve(mixture.components().size());
  for (const auto& [weight, gaussian] : mixture.components()) {
    const SignedDistance at_mean = obstacle.signed_distance(gaussian.mean_m());
    line.push_back(
        {weight, -at_mean.distance_m, std::sqrt(gaussian.variance_along_m2(at_mean.gradient))});
  }
  return line;
}

// All obstacles are visited: a heavy tail may come from any component. O(obstacles · components ·
// rounds).
double max_mixture_cvar_m(const Mixture& mixture, const World& world, double alpha) {
  double worst_m = -std::numeric_limits<double>::infinity();
  for (const ConvexObstacle& obstacle : world.convex_obstacles()) {
    worst_m =
        std::max(worst_m, mixture_tail_risk(negated_distance(mixture, obstacle), alpha).cvar_m);
  }
  return worst_m;
}

}  // namespace swarm
