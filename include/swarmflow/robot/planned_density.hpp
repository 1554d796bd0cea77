// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/flow_plan.hpp"

namespace swarm::agent {

/// The density of robots that the plan has at one plan time, as a robot with a kernel estimate sees
/// it: N χ(τ) convolved with the kernel, a Gaussian with Σ + κ² I for every leg alive [robots/m²].
/// All legs are in it, whichever a robot takes itself.
struct PlannedDensity {
  struct Part {
    Vec2 mean_m = Vec2::Zero();
    Mat2 precision = Mat2::Identity();  ///< (Σ + κ² I)⁻¹
    double peak_per_m2 = 0.0;
  };
  std::vector<Part> parts;

  struct Value {
    double per_m2 = 0.0;
    Vec2 gradient = Vec2::Zero();  ///< [robots/m³]
  };
  /// Cost: one exponential for every part within 4 σ.
  Value at(const Vec2& position_m) const;
};

/// The legs alive at τ; keeps the memory of `density`. `kernel_sigma_m` is κ, the kernel's standard
/// deviation per axis. O(legs). \pre the plan is not empty
void update(PlannedDensity& density, const FlowPlan& plan, double plan_time_s, double robots,
            double kernel_sigma_m);

}  // namespace swarm::agent
