// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/robot/planned_density.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/LU>

namespace swarm::agent {
namespace {

constexpr double kFar = 4.0;  // standard deviations: 0.03 % of a part's peak

}  // namespace

/// Sum of the parts' Gaussian densities and its gradient −Σ p Σ⁻¹(x − μ). O(parts).
PlannedDensity::Value PlannedDensity::at(const Vec2& position_m) const {
  Value value;
  for (const Part& part : parts) {
    const Vec2 offset = position_m - part.mean_m;
    const Vec2 weighted = part.precision * offset;
    const double squared = offset.dot(weighted);
    if (squared > kFar * kFar) continue;
    const double density = part.peak_per_m2 * std::exp(-0.5 * squared);
    value.per_m2 += density;
    value.gradient -= density * weighted;
  }
  return value;
}

/// Smoothing by a Gaussian kernel adds its variance to each covariance. Inverses and peaks are
/// computed here, once for all robots of a process.
void update(PlannedDensity& density, const FlowPlan& plan, double plan_time_s, double robots,
            double kernel_sigma_m) {
  density.parts.clear();
  const Mixture mixture = plan.mixture_at(MissionTime(plan_time_s));
  for (const WeightedGaussian& c : mixture.components()) {
    const Mat2 covariance =
        c.gaussian.covariance_m2() + kernel_sigma_m * kernel_sigma_m * Mat2::Identity();
    density.parts.push_back(
        {.mean_m = c.gaussian.mean_m(),
         .precision = covariance.inverse(),
         .peak_per_m2 =
             robots * c.weight / (2.0 * std::numbers::pi * std::sqrt(covariance.determinant()))});
  }
}

}  // namespace swarm::agent
