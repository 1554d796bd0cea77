// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "swarmflow/core/linalg.hpp"

namespace swarm::agent {

/// What a base with two driven wheels is to do for a short time.
struct UnicycleMotion {
  double speed_mps = 0.0;  ///< v, forwards, at least 0
  double turn_rad = 0.0;   ///< by how much it turns in that time, counter-clockwise
};

/// How such a base follows a velocity u of the plane. It turns to the direction of u as fast as it
/// can, and meanwhile drives the slower the more it is off:
///
///   v = ‖u‖ max(0, 1 − |e|/e₀),  e = ∠u − θ,  e₀ = 0.5 rad,  |turn| ≤ ω_max · time
///
/// So it never drives backwards and turns on the spot when u points elsewhere. A turn from rest
/// into u leads off its line by ‖u‖ e₀²/(6 ω_max) at most, 2 cm at 1.45 m/s and 3 rad/s; driving at
/// ‖u‖ cos e while it turns led into walls. Of u = 0 it keeps its heading. Simulated bodies and the
/// drivers of real ones use it. Pure.
/// \param heading_rad θ, counter-clockwise from the x axis
/// \param velocity_mps u, world frame [m/s]
/// \param turn_rate_max_radps ω_max [rad/s]
/// \param time_s the time of the turn: at least what passes until the next call, and of a real base
///   at least its delay, or it oscillates about the direction [s]
inline UnicycleMotion follow_by_unicycle(double heading_rad, const Vec2& velocity_mps,
                                         double turn_rate_max_radps, double time_s) {
  constexpr double kDrivesWithin_rad = 0.5;  // e₀
  constexpr double kAtRest_mps = 1e-9;       // has no direction
  const double speed_mps = velocity_mps.norm();
  if (speed_mps <= kAtRest_mps) return {};
  const double off_rad = std::remainder(
      std::atan2(velocity_mps.y(), velocity_mps.x()) - heading_rad, 2.0 * std::numbers::pi);
  const double most_rad = turn_rate_max_radps * time_s;
  return {.speed_mps = speed_mps * std::max(0.0, 1.0 - std::abs(off_rad) / kDrivesWithin_rad),
          .turn_rad = std::clamp(off_rad, -most_rad, most_rad)};
}

}  // namespace swarm::agent
