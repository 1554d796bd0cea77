// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "robot_agent/neighbours/neighbour_table.hpp"

namespace swarm::agent {

/// Range and strength of the field.
struct GiveWayFieldOptions {
  double radius_m = 0.2;
  double gap_m = 0.35;    ///< g0; above the safety filter's margin
  double strength = 8.0;  ///< k, at contact
};

/// The robot nearer to the goal goes first: not in the paper, whose robots may overlap.
///
///   PF_yield = k Σ_j (1 − gap_j/g0) (x − x_j)/‖x − x_j‖
///
/// over the j with gap_j < g0 that are nearer to this robot's immediate goal than itself.
///
/// Bodies that cannot overlap and all press on form a stable arch before a gap: no robot can go on
/// unless another goes back. This field makes the farther one of each pair go back, so that one
/// robot at least has nothing to yield to. No unit. O(neighbours).
inline Vec2 give_way_field(const Vec2& position_m, const Vec2& goal_m,
                           std::span<const Neighbour> neighbours,
                           const GiveWayFieldOptions& options) {
  const double own_squared = (goal_m - position_m).squaredNorm();
  Vec2 sum = Vec2::Zero();
  for (const Neighbour& n : neighbours) {
    const Vec2 away_m = position_m - n.position_m;
    const double distance_m = away_m.norm();
    const double gap_m = distance_m - options.radius_m - n.radius_m;
    // Few neighbours are in range, so this branch is predictable.
    if (gap_m >= options.gap_m || distance_m < 1e-9) continue;
    if ((goal_m - n.position_m).squaredNorm() >= own_squared) continue;
    sum += (1.0 - gap_m / options.gap_m) / distance_m * away_m;
  }
  return options.strength * sum;
}

}  // namespace swarm::agent
