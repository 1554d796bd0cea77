// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/linalg.hpp"

namespace swarm::agent {

/// How a body follows a commanded velocity: f of x(k+1) = f(x(k), u(k)) [ROVER, eq. 9]. Without
/// noise.
class MotionModel {
 public:
  virtual ~MotionModel() = default;

  /// Moves on for `time_s` ≥ 0 while `wanted_mps` (world frame) is commanded.
  virtual void advance(double time_s, const Vec2& wanted_mps) = 0;

  /// Puts the body elsewhere, its motion unchanged.
  virtual void displace(const Vec2& by_m) = 0;

  virtual Vec2 position_m() const = 0;
  virtual Vec2 velocity_mps() const = 0;
  virtual bool has_lag() const = 0;  ///< whether it takes time to reach a commanded velocity
};

/// A velocity shortened to the body's top speed.
inline Vec2 limited(const Vec2& velocity_mps, double speed_max_mps) {
  const double speed_mps = velocity_mps.norm();
  return speed_mps > speed_max_mps ? Vec2(velocity_mps * (speed_max_mps / speed_mps))
                                   : velocity_mps;
}

}  // namespace swarm::agent
