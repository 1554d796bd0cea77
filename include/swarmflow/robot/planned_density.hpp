// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarmflow/core/flow_plan.hpp"
#include "swarmflow/core/linalg.hpp"

namespace swarm::agent {

/// The planned density ρ* of the swarm at one plan time τ, smoothed by the kernel with which a
/// robot estimates the density of its neighbours [SwarmPRM, eq. 14]:
///
///   ρ*(x) = N (χ(τ) ∗ N(0, κ²I))(x) = N Σ πᵢ N(x; μᵢ, Σᵢ + κ²I)      over the legs in use at τ
///
/// All legs count, also those that a robot does not take itself.
struct PlannedDensity {
  /// One component of the mixture, ready for evaluation.
  struct Part {
    Vec2 mean_m = Vec2::Zero();         ///< μᵢ [m]
    Mat2 precision = Mat2::Identity();  ///< (Σᵢ + κ²I)⁻¹ [1/m²]
    double peak_per_m2 = 0.0;           ///< its density at the mean [robots/m²]
  };
  std::vector<Part> parts;  ///< the components, in the order of FlowPlan::mixture_at()

  /// ρ* and its gradient at one point.
  struct Value {
    double per_m2 = 0.0;           ///< ρ*(x) [robots/m²]
    Vec2 gradient = Vec2::Zero();  ///< ∇ρ*(x) [robots/m³]
  };
  /// ρ* and ∇ρ* at a point; parts farther than 4 σ are left out (0.03 % of their peak). O(parts),
  /// one exponential for every part that counts; does not allocate.
  Value at(const Vec2& position_m) const;
};

/// Replaces the parts by those of plan time τ. O(nodes + legs), allocates.
/// \param density overwritten; its memory is used again
/// \param plan the plan in force
/// \param plan_time_s τ [s]
/// \param robots N, the number of robots of the swarm
/// \param kernel_sigma_m κ, the kernel's standard deviation per axis [m]
/// \pre the plan is not empty, asserted
void update(PlannedDensity& density, const FlowPlan& plan, double plan_time_s, double robots,
            double kernel_sigma_m);

}  // namespace swarm::agent
