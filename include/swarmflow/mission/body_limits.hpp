// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/mission/catalogue.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm {

/// λ: longest time that a body takes to reach a commanded velocity [s], from what its driver
/// declares and the body's limits:
///
///   λ = fixed_s + v_max / a_max (if it accelerates) + (π/2) / ω_max (if it turns)
double declared_lag_s(const BodySpec& body, const LagSpec& lag);

/// λ of a body of a mission [s]: BodySpec::lag_s, or 0 where that is not set.
double body_lag_s(const BodySpec& body);

/// Density and speed of a plan that robots can follow. Each number is the one of the most
/// restrictive body of the mission.
struct SwarmLimits {
  /// Density of a hexagonal packing [robots/m²]:
  ///
  ///   2/(√3 d²),   d = 2 r + safety.neighbour_margin_m + ¼ v_max λ
  ///
  /// λ is body_lag_s(): the safety filter slows a robot down earlier by that much.
  double packing_per_m2 = 0.0;
  /// Density cap of plans, ¾ of that packing: robots that flow need room to pass each other
  /// [robots/m²]. In runs of 500 robots the error of the swarm grows above 0.9 of the packing.
  double cap_per_m2 = 0.0;
  /// Largest speed of a plan's means [m/s]: (0.9 − 0.4/s · min(λ, 0.5 s)) of the slowest robot's
  /// speed, so that a robot that fell behind catches up.
  double plan_speed_mps = 0.0;
  /// Largest speed that a plan may demand of a single robot: 0.93 of the slowest robot's [m/s].
  double robot_speed_mps = 0.0;
  /// Factor on lengths and speeds that are constants of a planning method and hold for bodies of
  /// 0.2 m and 1.5 m/s: the one of r / 0.2 m and v / 1.5 m/s that is nearer to 1, of the largest
  /// body.
  double length_scale = 1.0;
};

/// The limits of a mission. A robot's speed is the smaller of its speed_max_mps and
/// control.cruise_mps. O(groups).
SwarmLimits swarm_limits(const RobotsSpec& robots, const SafetySpec& safety,
                         const ControlSpec& control);

}  // namespace swarm
