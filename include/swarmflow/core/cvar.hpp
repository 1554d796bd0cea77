// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/gaussian.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm {

/// Φ⁻¹(p), the standard normal quantile; absolute error below 1e-12. \pre 0 < p < 1, asserted
double standard_normal_quantile(double p);

/// Coefficient of the CVaR of a normal variable:
///
///   k(α) = φ(Φ⁻¹(1−α))/α,   CVaR_α(N(μ, σ²)) = μ + k(α) σ          [SwarmPRM, eq. 7]
///
/// φ and Φ are the standard normal density and distribution function. Always positive, k(0.05) =
/// 2.0627. Evaluate it once per risk level: the functions below take k instead of α.
/// \pre 0 < alpha < 1, asserted
double cvar_coefficient(double alpha);

/// The risk limit of a plan: CVaR_α(−s) ≤ δ for every convex obstacle, s the signed distance to it
/// [SwarmPRM, eq. 12; ROVER, eq. 10b]. That is: averaged over the worst share α of cases, robots
/// keep a distance of at least −δ from the obstacle.
struct RiskLimit {
  double alpha = 0.05;    ///< α: share of the tail that is averaged, in (0, 1)
  double delta_m = -0.2;  ///< δ: threshold of the safe region, ≤ 0 [m]
};

/// CVaR_α of the negated signed distance of a Gaussian to one convex obstacle, linearised at the
/// mean [m]:
///
///   η' ~ N(−s(μ, O), nᵀΣn),   CVaR_α(η') = −s(μ, O) + k √(nᵀΣn)    [SwarmPRM, eq. 10–12]
///
/// O(1), does not allocate.
/// \param g the Gaussian N(μ, Σ)
/// \param at_mean s(μ, O) and its gradient n, from ConvexObstacle::signed_distance(g.mean_m())
/// \param k cvar_coefficient(α)
double obstacle_cvar_m(const Gaussian& g, const SignedDistance& at_mean, double k);

/// Largest obstacle_cvar_m() over all convex obstacles of the world [m]; −∞ for a world without
/// obstacles. The Gaussian keeps the limit [SwarmPRM, eq. 12] if and only if the result is ≤ δ.
/// Obstacles whose box shows that they cannot have the largest value are skipped.
/// \param k cvar_coefficient(α)
double max_cvar_m(const Gaussian& g, const World& world, double k);

/// INFREE of [SwarmPRM, Alg. 1]: whether CVaR_α ≤ δ (eq. 12) holds for every convex obstacle. Stops
/// at the first obstacle that violates it, so it is cheaper than max_cvar_m().
/// \param k cvar_coefficient(α)
/// \param delta_m δ ≤ 0 [m]
bool in_free(const Gaussian& g, const World& world, double k, double delta_m);

}  // namespace swarm
