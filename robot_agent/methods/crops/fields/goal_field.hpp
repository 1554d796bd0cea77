// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "swarmflow/core/linalg.hpp"

namespace swarm::agent {

/// The sigmoid's parameters, by the paper's code.
struct GoalFieldOptions {
  double floor = 0.75;            ///< strength that remains at the goal: 60 of 80 in the code
  double rise = 0.25;             ///< of the sigmoid
  double offset = 50.0;           ///< β of the sigmoid
  double steepness_per_m = 14.0;  ///< δ: 0.7 px⁻¹
};

/// Attraction to the immediate goal, a weak sigmoid [CRoPS, attraction to immediate goal].
///
///   PF_igoal = (g − x)/‖g − x‖ (c + α/(1 + β exp(−δ ‖g − x‖)))
///
/// The form of the paper's code: the paper's own, (g − x)/(1 + exp(δ ‖g − x‖)), vanishes with the
/// distance, so that a robot would not leave its start. No unit: the strength far from the goal is
/// 1, the measure of all fields.
inline Vec2 goal_field(const Vec2& position_m, const Vec2& goal_m,
                       const GoalFieldOptions& options) {
  const Vec2 path_m = goal_m - position_m;
  const double distance_m = path_m.norm();
  if (distance_m < 1e-9) return Vec2::Zero();
  const double sigmoid = 1.0 + options.offset * std::exp(-options.steepness_per_m * distance_m);
  return path_m / distance_m * (options.floor + options.rise / sigmoid);
}

}  // namespace swarm::agent
