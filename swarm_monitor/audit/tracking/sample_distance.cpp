// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/sample_distance.hpp"

#include <algorithm>
#include <cmath>

#include "swarm_core/base/assert.hpp"
#include "swarm_core/metrics/assignment.hpp"

namespace swarm::monitor {
namespace {

/// Upper bound of a cost that the assignment accepts [m²]: beyond 30 km a robot is as far off as it
/// can be.
constexpr double kMostSquared_m2 = 1e9;

}  // namespace

/// A point u in [0, 1) selects the component whose cumulative weight holds it; the points of one
/// component are then drawn independently, mean + L·z with the Cholesky factor L of its covariance.
std::vector<Vec2> fair_sample(const Mixture& mixture, std::size_t n, Rng& rng) {
  std::vector<Vec2> points;
  points.reserve(n);
  const double offset = uniform01(rng);
  const auto& components = mixture.components();
  std::size_t component = 0;
  double below = 0.0;  // weight of the components before this one
  for (std::size_t i = 0; i < n; ++i) {
    const double u = (static_cast<double>(i) + offset) / static_cast<double>(n);
    while (component + 1 < components.size() && u >= below + components[component].weight) {
      below += components[component].weight;
      ++component;
    }
    const Gaussian& gaussian = components[component].gaussian;
    const double x = standard_normal(rng);
    const double y = standard_normal(rng);
    points.push_back(gaussian.mean_m() + cholesky_lower(gaussian.covariance_m2()) * Vec2(x, y));
  }
  return points;
}

/// Squared distances as costs; the optimal assignment of equally weighted points is the optimal
/// transport between them.
double w2_m(std::span<const Vec2> a, std::span<const Vec2> b) {
  SWARM_ASSERT(a.size() == b.size());
  if (a.empty()) return 0.0;
  std::vector<double> costs_m2;
  costs_m2.reserve(a.size() * b.size());
  for (const Vec2& p : a) {
    for (const Vec2& q : b) costs_m2.push_back(std::min(kMostSquared_m2, (p - q).squaredNorm()));
  }
  return std::sqrt(assignment_cost(costs_m2, a.size()) / static_cast<double>(a.size()));
}

/// The floor is the distance that a perfect swarm would have: two samples of n points differ by
/// chance. Only W2 above it is an error of the swarm.
Distance distance_to(const Mixture& mixture, std::span<const Vec2> points, std::size_t draws,
                     Rng& rng) {
  SWARM_ASSERT(draws >= 2);
  std::vector<std::vector<Vec2>> samples;
  for (std::size_t k = 0; k < draws; ++k) {
    samples.push_back(fair_sample(mixture, points.size(), rng));
  }
  Distance distance;
  for (std::size_t k = 0; k < draws; ++k) {
    distance.w2_m += w2_m(points, samples[k]) / static_cast<double>(draws);
  }
  // Two draws are one pair; of more, each is compared with the next one, in a ring.
  const std::size_t pairs = draws == 2 ? 1 : draws;
  for (std::size_t k = 0; k < pairs; ++k) {
    distance.floor_m += w2_m(samples[k], samples[(k + 1) % draws]) / static_cast<double>(pairs);
  }
  return distance;
}

}  // namespace swarm::monitor
