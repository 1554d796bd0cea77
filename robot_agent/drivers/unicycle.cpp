// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/drivers/unicycle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace swarm::agent {
namespace {

// Longest step of integration.
constexpr double kStep_s = 0.005;
// e₀: with a larger heading error it turns on the spot.
constexpr double kDrivesWithin_rad = 0.5;

Vec2 direction(double heading_rad) { return {std::cos(heading_rad), std::sin(heading_rad)}; }

/// An angle in [−π, π].
double wrapped(double angle_rad) { return std::remainder(angle_rad, 2.0 * std::numbers::pi); }

}  // namespace

Vec2 Unicycle::velocity_mps() const { return speed_mps_ * direction(heading_rad_); }

void Unicycle::advance(double time_s, const Vec2& wanted_mps) {
  const Vec2 wanted = limited(wanted_mps, limits_.speed_max_mps);
  double left_s = time_s;
  for (; left_s > kStep_s; left_s -= kStep_s) step(kStep_s, wanted);
  step(left_s, wanted);
}

/// One step: turns towards the commanded direction and changes speed, both within the limits.
void Unicycle::step(double time_s, const Vec2& wanted_mps) {
  const double wanted_speed_mps = wanted_mps.norm();
  double turn_rad = 0.0;
  double target_mps = 0.0;
  // A zero velocity has no direction: it keeps its heading.
  if (wanted_speed_mps > 1e-9) {
    const double off_rad = wrapped(std::atan2(wanted_mps.y(), wanted_mps.x()) - heading_rad_);
    const double most_rad = limits_.turn_rate_max_radps * time_s;
    turn_rad = std::clamp(off_rad, -most_rad, most_rad);
    target_mps = wanted_speed_mps * std::max(0.0, 1.0 - std::abs(off_rad) / kDrivesWithin_rad);
  }
  const double most_mps = limits_.acceleration_max_mps2 * time_s;
  const double before_mps = speed_mps_;
  speed_mps_ += std::clamp(target_mps - speed_mps_, -most_mps, most_mps);
  // Along the chord of the arc, at the mean speed.
  position_m_ +=
      0.5 * (before_mps + speed_mps_) * time_s * direction(heading_rad_ + 0.5 * turn_rad);
  heading_rad_ = wrapped(heading_rad_ + turn_rad);
}

}  // namespace swarm::agent
