// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>

#include "swarmflow/core/linalg.hpp"

namespace swarm::agent {

/// How fast a robot is attracted to a point at the distance d [m/s]:
///
///   v(d) = min(b + k d, b′ + k′ d), clamped to [0, c]
///
/// Line (b, k) is the robot's pace (pace.hpp), line (b′, k′) lets it slow down before the end of
/// its path; c is the largest desired speed.
struct AttractionSpeed {
  double pace_mps = 0.0;                                          ///< b
  double pace_hz = 0.0;                                           ///< k
  double approach_mps = std::numeric_limits<double>::infinity();  ///< b′
  double approach_hz = 0.0;                                       ///< k′
  double cruise_mps = 0.0;                                        ///< c

  double at(double distance_m) const {
    const double pace = pace_mps + pace_hz * distance_m;
    const double approach = approach_mps + approach_hz * distance_m;
    return std::clamp(std::min(pace, approach), 0.0, cruise_mps);
  }
};

/// The attraction of SwarmPRM's field [eq. 14] to the aim point on the robot's path through the
/// flow [m/s], −∂U_att/∂x with the potential
///
///   U_att(x) = ∫₀^d v(s) ds,    d = ‖aim − x‖        [m²/s]
///
/// so it points at the aim and has the speed v(d).
inline Vec2 attraction(const Vec2& position_m, const Vec2& aim_m, const AttractionSpeed& speed) {
  const Vec2 offset = aim_m - position_m;
  const double distance = offset.norm();
  if (distance < 1e-9) return Vec2::Zero();
  return offset * (speed.at(distance) / distance);
}

/// Without a clock: at cruise speed, slower in proportion to what is left of the path, `rest_m` of
/// it behind the aim.
inline AttractionSpeed free_speed(double rest_m, double approach_gain_hz, double cruise_mps) {
  return {
      .pace_mps = approach_gain_hz * rest_m, .pace_hz = approach_gain_hz, .cruise_mps = cruise_mps};
}

}  // namespace swarm::agent
