// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <span>

#include "robot_agent/neighbours/neighbour_table.hpp"

namespace swarm::agent {

/// Which neighbours count, and how much.
struct HeadingFieldOptions {
  double mean_m = 1.2;      ///< μ: distance of the neighbours with the largest weight
  double sigma_m = 0.5;     ///< σ: spread of the weight around that distance
  double moving_mps = 0.3;  ///< slower neighbours count as stuck and are left out
  double strength = 0.6;    ///< of all headings together
};

/// Influence of the neighbours' headings [CRoPS, neighbor heading influence].
///
///   PF_heading = k Σ_j γ_j h_j / Σ_j γ_j      h_j = v_j/‖v_j‖ heading of neighbour j
///   γ_j = exp(−(‖x − x_j‖ − μ)²/2σ²)
///
/// Neighbours that are stuck (hardly move) are not chosen. The paper draws some neighbours by γ;
/// weighing all of them with it is what that gives on average. No unit. O(neighbours).
inline Vec2 heading_field(const Vec2& position_m, std::span<const Neighbour> neighbours,
                          const HeadingFieldOptions& options) {
  Vec2 sum = Vec2::Zero();
  double weights = 0.0;
  for (const Neighbour& n : neighbours) {
    const double speed_mps = n.velocity_mps.norm();
    if (speed_mps < options.moving_mps) continue;
    const double off = ((position_m - n.position_m).norm() - options.mean_m) / options.sigma_m;
    const double weight = std::exp(-0.5 * off * off);
    sum += weight / speed_mps * n.velocity_mps;
    weights += weight;
  }
  constexpr double kNegligibleWeight = 0.05;  // one that is 2.4 σ off
  if (weights < kNegligibleWeight) return Vec2::Zero();
  return options.strength / weights * sum;
}

}  // namespace swarm::agent
