// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/cvar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "swarm_core/base/assert.hpp"

namespace swarm {
namespace {

double normal_pdf(double x) { return std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi); }

double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

// Rational start for p ≤ ½, off by less than 4.5e-4 [Abramowitz and Stegun, 26.2.23].
double rough_lower_quantile(double p) {
  const double t = std::sqrt(-2.0 * std::log(p));
  return (2.515517 + t * (0.802853 + t * 0.010328)) /
             (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308))) -
         t;
}

// Halley on Φ(x) = p, which triples the digits: two rounds reach the last bit, one is to spare.
double lower_quantile(double p) {
  double x = rough_lower_quantile(p);
  for (int round = 0; round < 3; ++round) {
    const double newton_step = (normal_cdf(x) - p) / normal_pdf(x);
    x -= newton_step / (1.0 + 0.5 * x * newton_step);
  }
  return x;
}

// Whether the obstacle's box alone proves CVaR ≤ threshold: outside it, sd ≥ distance to the box.
bool box_rules_out(const ConvexObstacle& obstacle, const Vec2& mean_m, double spread_m,
                   double threshold_m) {
  const double box_distance_m = obstacle.box.distance_m(mean_m);
  return box_distance_m > 0.0 && spread_m - box_distance_m <= threshold_m;
}

}  // namespace

// Φ⁻¹(p), used for VaR and CVaR of Gaussians.
double standard_normal_quantile(double p) {
  SWARM_ASSERT(p > 0.0 && p < 1.0);
  // The lower tail keeps its relative precision, so the upper half is mirrored (1 − p is exact
  // there).
  return p <= 0.5 ? lower_quantile(p) : -lower_quantile(1.0 - p);
}

// k(α) = φ(Φ⁻¹(1−α))/α [SwarmPRM, eq. 7]. φ is even, so Φ⁻¹(α) serves as well and keeps its digits
// for small α.
double cvar_coefficient(double alpha) {
  SWARM_ASSERT(alpha > 0.0 && alpha < 1.0);
  return normal_pdf(standard_normal_quantile(alpha)) / alpha;
}

// [SwarmPRM, eqs. 10–11]: the signed distance is linearised at the mean, so −s is Gaussian with
// mean −s(μ) and variance n'Σn.
double obstacle_cvar_m(const Gaussian& g, const SignedDistance& at_mean, double k) {
  return -at_mean.distance_m + k * std::sqrt(g.variance_along_m2(at_mean.gradient));
}

// Branch and bound. A few obstacles near the mean give a lower bound of the maximum; an obstacle
// whose box is farther than `spread_m - bound_m` has a smaller CVaR and is never visited.
double max_cvar_m(const Gaussian& g, const World& world, double k) {
  const Vec2& mean_m = g.mean_m();
  const std::vector<ConvexObstacle>& obstacles = world.convex_obstacles();
  const double spread_m = k * g.max_sigma_m();
  const auto cvar_m = [&](std::uint32_t i) {
    return obstacle_cvar_m(g, obstacles[i].signed_distance(mean_m), k);
  };
  constexpr double kInfinity_m = std::numeric_limits<double>::infinity();
  double bound_m = -kInfinity_m;
  world.convex_boxes().for_some_near(
      mean_m, [&](std::uint32_t i) { bound_m = std::max(bound_m, cvar_m(i)); });
  double worst_m = -kInfinity_m;
  world.convex_boxes().for_each_within({mean_m, mean_m}, spread_m - bound_m, [&](std::uint32_t i) {
    if (box_rules_out(obstacles[i], mean_m, spread_m, worst_m)) return;
    worst_m = std::max(worst_m, cvar_m(i));
  });
  return worst_m;
}

// INFREE of [SwarmPRM, Alg. 1]. Unlike max_cvar_m() it stops at the first obstacle over the
// threshold.
bool in_free(const Gaussian& g, const World& world, double k, double delta_m) {
  const Vec2& mean_m = g.mean_m();
  const std::vector<ConvexObstacle>& obstacles = world.convex_obstacles();
  const double spread_m = k * g.max_sigma_m();
  return !world.convex_boxes().any_within(
      {mean_m, mean_m}, spread_m - delta_m, [&](std::uint32_t i) {
        return !box_rules_out(obstacles[i], mean_m, spread_m, delta_m) &&
               obstacle_cvar_m(g, obstacles[i].signed_distance(mean_m), k) > delta_m;
      });
}

}  // namespace swarm
