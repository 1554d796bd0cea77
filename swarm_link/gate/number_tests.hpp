// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "swarm_link/gate/wire_limits.hpp"
#include "swarmflow/core/gaussian.hpp"

/// Number checks used by the content checks.
namespace swarm::link {

/// Whether none of the numbers is NaN or infinite.
template <class... Numbers>
bool all_finite(Numbers... numbers) {
  return (std::isfinite(numbers) && ...);
}

/// Whether the axes of a covariance differ by a factor of 10⁵ at most: beyond that the transport
/// map between two Gaussians is lost in rounding. \pre finite, positive definite
inline bool is_well_shaped(const Mat2& covariance_m2) {
  constexpr double kMostRatio = 1e10;  // of the variances
  const double half_trace = 0.5 * covariance_m2.trace();
  const double determinant = covariance_m2.determinant();
  const double largest =
      half_trace + std::sqrt(std::max(0.0, half_trace * half_trace - determinant));
  return largest * largest <= kMostRatio * determinant;
}

/// Whether a point lies inside the bounds plus slack. \pre finite coordinates
inline bool is_inside(double x_m, double y_m, const WireLimits& limits) {
  return limits.bounds_m.distance_m({x_m, y_m}) <= limits.bounds_slack_m;
}

}  // namespace swarm::link
