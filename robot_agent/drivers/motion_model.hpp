// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/linalg.hpp"

namespace swarm::agent {

/// What a body can do with a velocity it is given: f of x(k+1) = f(x(k), u(k)) [ROVER, eq. 9]. Moves
/// by the time it is given, without noise.
class MotionModel {
 public:
  virtual ~MotionModel() = default;

  /// Moves on for `time_s` ≥ 0 while `wanted_mps` (world frame) is commanded.
  virtual void advance(double time_s, const Vec2& wanted_mps) = 0;

  /// Puts the body elsewhere, its motion unchanged.
  virtual void displace(const Vec2& by_m) = 0;

  virtual Vec2 position_m() const = 0;
  virtual Vec2 velocity_mps() const = 0;
  virtual bool has_lag() const = 0;  ///< whether it takes time to be at a velocity it is given
};

/// The part of a velocity that a body with this top speed can do.
inline Vec2 limited(const Vec2& velocity_mps, double speed_max_mps) {
  const double speed_mps = velocity_mps.norm();
  return speed_mps > speed_max_mps ? Vec2(velocity_mps * (speed_max_mps / speed_mps))
                                   : velocity_mps;
}

}  // namespace swarm::agent
