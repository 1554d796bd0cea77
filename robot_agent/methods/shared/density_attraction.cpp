// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/methods/shared/density_attraction.hpp"

#include <numbers>

namespace swarm::agent {
namespace {

constexpr double kNone_per_m2 = 1e-9;  // neither robots here nor planned here

/// Kernel estimate ρ̂ of the neighbours' density and its gradient; the robot itself does not count.
PlannedDensity::Value estimate(const Vec2& position_m, std::span<const Neighbour> neighbours,
                               double kernel_m) {
  const double h2 = kernel_m * kernel_m;
  PlannedDensity::Value value;
  for (const Neighbour& n : neighbours) {
    const Vec2 offset = position_m - n.position_m;
    // Which neighbours are in range is unpredictable: no branch.
    const double left = positive_part(1.0 - offset.squaredNorm() / h2);
    value.per_m2 += left * left;
    value.gradient -= 4.0 / h2 * left * offset;
  }
  const double scale = 3.0 / (std::numbers::pi * h2);
  return {scale * value.per_m2, scale * value.gradient};
}

}  // namespace

double density_potential(const Vec2& position_m, const PlannedDensity& planned,
                         std::span<const Neighbour> neighbours,
                         const DensityAttractionOptions& options) {
  const double real = estimate(position_m, neighbours, options.kernel_m).per_m2;
  const double wanted = planned.at(position_m).per_m2;
  if (real + wanted < kNone_per_m2) return 0.0;
  return options.push_mps * options.kernel_m * (real - wanted) / (real + wanted);
}

/// Cut to p, since the gradient grows without bound where both densities are small.
Vec2 density_attraction(const Vec2& position_m, const PlannedDensity& planned,
                        std::span<const Neighbour> neighbours,
                        const DensityAttractionOptions& options) {
  const PlannedDensity::Value real = estimate(position_m, neighbours, options.kernel_m);
  const PlannedDensity::Value wanted = planned.at(position_m);
  const double sum = real.per_m2 + wanted.per_m2;
  if (sum < kNone_per_m2) return Vec2::Zero();
  // d/dx (a − b)/(a + b) = 2 (b a′ − a b′) / (a + b)²
  const Vec2 u = -2.0 * options.push_mps * options.kernel_m / (sum * sum) *
                 (wanted.per_m2 * real.gradient - real.per_m2 * wanted.gradient);
  const double speed = u.norm();
  return speed > options.push_mps ? Vec2(u * (options.push_mps / speed)) : u;
}

}  // namespace swarm::agent
