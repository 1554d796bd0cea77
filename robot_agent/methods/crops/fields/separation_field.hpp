// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <span>

#include "robot_agent/neighbours/neighbour_table.hpp"

namespace swarm::agent {

/// Range and strength of the field.
struct SeparationFieldOptions {
  double reach_m = 2.4;          ///< Δ_sep, between centres: 48 px
  double steepness_per_m = 2.0;  ///< δ_sep
  double gain_per_m = 3.0;       ///< of the field: at most 0.28 gain/δ a neighbour
};

/// Repulsion from other robots, a weak sigmoid [CRoPS, repulsion from other robots].
///
///   PF_sep = k Σ_j (x − x_j) / (1 + exp(δ_sep ‖x − x_j‖))  for ‖x − x_j‖ ≤ Δ_sep
///
/// It is strongest at δ ‖x − x_j‖ = 1.28 (0.64 m), weaker than obstacles wherever those are near.
/// No unit. O(neighbours).
inline Vec2 separation_field(const Vec2& position_m, std::span<const Neighbour> neighbours,
                             const SeparationFieldOptions& options) {
  Vec2 sum = Vec2::Zero();
  for (const Neighbour& n : neighbours) {
    const Vec2 away_m = position_m - n.position_m;
    const double distance_m = away_m.norm();
    if (distance_m > options.reach_m) continue;
    sum += away_m / (1.0 + std::exp(options.steepness_per_m * distance_m));
  }
  return options.gain_per_m * sum;
}

}  // namespace swarm::agent
