// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "swarmflow/core/world.hpp"

namespace swarm::agent {

/// Range and strength of the push.
struct ObstacleRepulsionOptions {
  double radius_m = 0.2;
  double gap_m = 0.5;     ///< s0
  double push_mps = 1.0;  ///< at contact
};

/// −∂U_rep/∂x of the nearest obstacle [m/s] [SwarmPRM, eq. 14]: p (1 − s/s0) along the gradient of
/// the signed distance while the surface gap s is below s0.
inline Vec2 obstacle_repulsion(const Vec2& position_m, const World& world,
                               const ObstacleRepulsionOptions& options) {
  if (world.is_clear(position_m, options.radius_m + options.gap_m)) return Vec2::Zero();
  const SignedDistance sd = world.signed_distance(position_m);
  const double gap = sd.distance_m - options.radius_m;
  if (gap >= options.gap_m) return Vec2::Zero();
  return options.push_mps * std::min(1.0, 1.0 - gap / options.gap_m) * sd.gradient;
}

}  // namespace swarm::agent
