// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/drivers/unicycle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "swarmflow/robot/unicycle_law.hpp"

namespace swarm::agent {
namespace {

// Longest step of integration.
constexpr double kStep_s = 0.005;

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
  const auto [target_mps, turn_rad] =
      follow_by_unicycle(heading_rad_, wanted_mps, limits_.turn_rate_max_radps, time_s);
  const double most_mps = limits_.acceleration_max_mps2 * time_s;
  const double before_mps = speed_mps_;
  speed_mps_ += std::clamp(target_mps - speed_mps_, -most_mps, most_mps);
  // Along the chord of the arc, at the mean speed.
  position_m_ +=
      0.5 * (before_mps + speed_mps_) * time_s * direction(heading_rad_ + 0.5 * turn_rad);
  heading_rad_ = wrapped(heading_rad_ + turn_rad);
}

}  // namespace swarm::agent
