// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/methods/apf/cotangent_repulsion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace swarm::agent {
namespace {

constexpr double kLeastShare = 1e-3;  // of R: least distance used, as G is infinite at 0

/// cot θ and csc² θ, of which G and its derivatives are made.
struct Cotangent {
  double cot;
  double csc_squared;
};

Cotangent cotangent(double theta) {
  const double sine = std::sin(theta);
  return {std::cos(theta) / sine, 1.0 / (sine * sine)};
}

// g''(d) = G₀ k csc²θ (2 k d² cot θ − 1) with k = π/R² and θ = kd²/2, where it is positive.
double bend(double d_squared, double pi_by_range_squared, double strength_m2) {
  const Cotangent c = cotangent(0.5 * pi_by_range_squared * d_squared);
  const double k = pi_by_range_squared;
  return std::max(0.0, strength_m2 * c.csc_squared * k * (2.0 * c.cot * k * d_squared - 1.0));
}

}  // namespace

/// Eq. 7 and its gradient, with the slope faded out near R where that is asked for.
Potential cotangent_repulsion(const Vec2& position_m, std::span<const Neighbour> neighbours,
                              const CotangentOptions& options, double reach_m) {
  const double range_squared = options.range_m * options.range_m;
  const double least_m = kLeastShare * options.range_m;
  const double k = std::numbers::pi / range_squared;
  Potential sum;
  for (const Neighbour& n : neighbours) {
    const Vec2 away = position_m - n.position_m;
    const double d_squared = std::max(away.squaredNorm(), least_m * least_m);
    if (d_squared >= range_squared) continue;
    const Cotangent c = cotangent(0.5 * k * d_squared);
    sum.energy_m2 += options.strength_m2 * c.cot;
    const double d_m = std::sqrt(d_squared);
    const double left = 1.0 - d_m / options.range_m;
    const double fade = left < options.fade_share ? left / options.fade_share : 1.0;
    sum.gradient_m -= fade * options.strength_m2 * c.csc_squared * k * away;
    // Both robots of a pair may approach by reach_m in this step: g'' is largest at the least
    // distance.
    const double nearer_m = std::max(least_m, d_m - 2.0 * reach_m);
    sum.curvature += 2.0 * bend(nearer_m * nearer_m, k, options.strength_m2);
  }
  return sum;
}

}  // namespace swarm::agent
