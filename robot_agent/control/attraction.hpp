// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "swarm_core/base/linalg.hpp"

namespace swarm::agent {

struct AttractionOptions {
  double cruise_mps = 1.45;
  double approach_gain_hz = 0.8;
};

/// −∂U_att/∂x: the pull towards the aim point on the own way through the flow [m/s] [SwarmPRM, eq.
/// 14].
///
///   U_att = ½ k d² for d ≤ c/k, else c d − ½ c²/k      d distance to the aim, k gain, c cruise
///   speed
///
/// Far from its aim the robot is carried along the flow at cruise speed (feed-forward); near the
/// end of its way it slows down in proportion to the distance left.
inline Vec2 attraction(const Vec2& position_m, const Vec2& aim_m, double left_m,
                       const AttractionOptions& options) {
  const Vec2 offset = aim_m - position_m;
  const double distance = offset.norm();
  if (distance < 1e-9) return Vec2::Zero();
  const double speed =
      std::min(options.cruise_mps, options.approach_gain_hz * std::max(left_m, distance));
  return offset * (speed / distance);
}

}  // namespace swarm::agent
