// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/mission/catalogue.hpp"
#include "swarmflow/mission/mission.hpp"

/// What bodies can do, as agent and planner both count on it.
namespace swarm {

/// How long a body takes until it moves at the velocity it was commanded, as its driver declares it
/// [s].
double declared_lag_s(const BodySpec& body, const LagSpec& lag);

/// The same of a body of a mission: BodySpec::lag_s, and zero where it is not set.
double body_lag_s(const BodySpec& body);

/// The density and the speed of a plan that robots can follow. The most restrictive body of the
/// mission decides each number.
struct SwarmLimits {
  /// Robots that fit: hexagonal packing, 2/(√3 d²), at the distance d = 2r + neighbour margin +
  /// ¼ v_max λ, λ the body's lag: by so much earlier its safety filter slows it down [robots/m²].
  double packing_per_m2 = 0.0;
  /// What a plan is capped at, ¾ of that: robots that flow need room to pass each other. In flights
  /// of 500 robots the error of the swarm grows above 0.9 of the packing [robots/m²].
  double cap_per_m2 = 0.0;
  /// Speed of the means at most: 0.9 of the slowest robot's, so that a robot that fell behind
  /// catches up; for bodies with λ ≥ 0.5 s 0.7 of it, linear in between [m/s].
  double plan_speed_mps = 0.0;
  /// Speed that a plan may ask of a single robot: 0.93 of the slowest robot's [m/s].
  double robot_speed_mps = 0.0;
};

/// A robot's speed is the smaller of its largest speed and control.cruise_mps.
SwarmLimits swarm_limits(const RobotsSpec& robots, const SafetySpec& safety,
                         const ControlSpec& control);

}  // namespace swarm
