// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/tail_limit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace swarm::planner {
namespace {

// The bracket doubles from σ: 2^60 σ is farther than any mean.
constexpr int kDoublings = 60;
constexpr int kRounds = 100;  // bisection alone would need 60

// The part of a component beyond z: its probability, its E[(Y − z)⁺] and its density at z.
struct Tail {
  double probability = 0.0;
  double excess_m = 0.0;
  double density = 0.0;
};

// For a normal Y with mean m and deviation σ, and u = (z − m)/σ: P(Y > z) = erfc(u/√2)/2 and E[(Y −
// z)⁺] = σ (φ(u) − u P). The difference is clamped at 0, where cancellation may make it negative.
Tail tail_of(const LineComponent& c, double z_m) {
  const double u = (z_m - c.mean_m) / c.sigma_m;
  if (u > 38.0) return {};  // below the smallest double
  const double bell = std::exp(-0.5 * u * u) / std::sqrt(2.0 * std::numbers::pi);
  const double probability = 0.5 * std::erfc(u / std::numbers::sqrt2);
  return {probability, std::max(0.0, c.sigma_m * (bell - u * probability)), bell / c.sigma_m};
}

// The tail of a mixture is the sum of its components' tails, by weight.
Tail tail_of(std::span<const LineComponent> components, double z_m) {
  Tail sum;
  for (const LineComponent& c : components) {
    const Tail tail = tail_of(c, z_m);
    sum.probability += c.weight * tail.probability;
    sum.excess_m += c.weight * tail.excess_m;
    sum.density += c.weight * tail.density;
  }
  return sum;
}

// (ε − z) P(Y > z) − E[(Y − z)⁺]: positive where the mean of the tail beyond z is below ε. Its
// slope in z is −(ε − z) times the density at z.
double slack_m(const Tail& tail, double z_m, double epsilon_m) {
  return (epsilon_m - z_m) * tail.probability - tail.excess_m;
}

}  // namespace

// First a bracket [low, high] with the root inside is found by doubling the distance below ε, then
// Newton steps narrow it. A step that would leave the bracket is replaced by bisection, so that the
// search converges even where the density vanishes.
TailAtLimit tail_at_limit(std::span<const LineComponent> components, double epsilon_m) {
  double sigma_m = 0.0;
  for (const LineComponent& c : components) {
    if (c.weight > 0.0) sigma_m = std::max(sigma_m, c.sigma_m);
  }
  if (sigma_m == 0.0) return {epsilon_m - 1.0, 0.0};
  double high_m = epsilon_m;
  double low_m = epsilon_m - sigma_m;
  Tail tail = tail_of(components, low_m);
  for (int i = 0; i < kDoublings && slack_m(tail, low_m, epsilon_m) < 0.0; ++i) {
    high_m = low_m;
    low_m = epsilon_m - 2.0 * (epsilon_m - low_m);
    tail = tail_of(components, low_m);
  }
  double z_m = low_m;
  for (int round = 0; round < kRounds; ++round) {
    const double slack = slack_m(tail, z_m, epsilon_m);
    (slack > 0.0 ? low_m : high_m) = z_m;
    const double slope = -(epsilon_m - z_m) * tail.density;
    double next_m = slope < 0.0 ? z_m - slack / slope : z_m;
    if (!(next_m > low_m && next_m < high_m)) next_m = 0.5 * (low_m + high_m);
    const bool converged = std::abs(next_m - z_m) <= 1e-12 * (1.0 + std::abs(z_m));
    z_m = next_m;
    tail = tail_of(components, z_m);
    if (converged) break;
  }
  return {z_m, tail.probability};
}

double risk_share(const LineComponent& component, double z_m, double epsilon_m) {
  return tail_of(component, z_m).excess_m / (epsilon_m - z_m);
}

}  // namespace swarm::planner
