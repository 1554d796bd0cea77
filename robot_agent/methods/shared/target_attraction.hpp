// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "robot_agent/methods/shared/potential.hpp"

namespace swarm::agent {

/// An intermediate target.
struct Target {
  Vec2 end_m = Vec2::Zero();
  double width_m = 1.0;  ///< w
};

/// The target at `end_m` for a robot at `start_m`. \pre radius_m > 0
inline Target target_from(const Vec2& start_m, const Vec2& end_m, double radius_m) {
  return {end_m, std::max((end_m - start_m).norm(), radius_m)};
}

/// Attraction to an intermediate target [intermittent diffusion, eq. 13], in the form of the
/// official code, a Gaussian well as wide as the distance to it, w = max(‖end − start‖, r):
///
///   K(x) = w² (1 − e),  ∇K = e (x − end),  e = exp(−‖x − end‖²/(2w²))
inline Potential target_attraction(const Vec2& position_m, const Target& target) {
  const Vec2 off = position_m - target.end_m;
  const double w_squared = target.width_m * target.width_m;
  const double e = std::exp(-0.5 * off.squaredNorm() / w_squared);
  return {w_squared * (1.0 - e), e * off, 1.0};
}

}  // namespace swarm::agent
