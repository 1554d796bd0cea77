// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/world.hpp"

namespace swarm::agent {

/// Range and strength of the field.
struct ObstacleFieldOptions {
  double radius_m = 0.2;
  double reach_m = 1.0;     ///< Δ_obst, of the surface gap
  double gain_m = 0.065;    ///< β: as strong as the goal's field at a gap of 0.15 m
  double gap_min_m = 0.02;  ///< the potential is no higher than here
};

/// Repulsion from obstacles, of the strength 1/gap² [CRoPS, repulsion from obstacles].
///
///   PF_obst = Σ_o (x − c_o) β/(d_o − r)²  for the obstacles with d_o − r ≤ Δ_obst
///             c_o nearest point of obstacle o, d_o = ‖x − c_o‖, r radius of the robot
///
/// No unit: strengths of fields are only compared with each other. The code's β (300 px at a goal
/// field of 80) is as strong as its goal's field at a gap of 0.2 m. O(obstacles in reach).
Vec2 obstacle_field(const Vec2& position_m, const World& world,
                    const ObstacleFieldOptions& options);

}  // namespace swarm::agent
