// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/gaussian.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm {

/// Φ⁻¹(p), the standard normal quantile; absolute error below 1e-12. \pre 0 < p < 1
double standard_normal_quantile(double p);

/// k(α) = φ(Φ⁻¹(1−α))/α, so that CVaR_α(N(μ, σ²)) = μ + k σ       [SwarmPRM, eq. 7]. k(0.05)
/// = 2.0627. \pre 0 < α < 1
double cvar_coefficient(double alpha);

/// The risk promise of a plan: CVaR_α(−sdf) ≤ δ for every convex obstacle.
struct RiskLimit {
  double alpha = 0.05;    ///< tail share, in (0, 1)
  double delta_m = -0.2;  ///< safe region threshold δ ≤ 0
};

/// CVaR of η' ~ N(−s(μ,O), nᵀΣn), the linearised negated signed distance of a Gaussian to one
/// convex obstacle [m]                                                           [SwarmPRM, eq.
/// 10–12].
double obstacle_cvar_m(const Gaussian& g, const SignedDistance& at_mean, double k);

/// Largest CVaR over all convex obstacles of the world [m]; −∞ for a world without obstacles.
/// Holds (12) iff the result ≤ δ. Obstacles that cannot be the largest are skipped by their box.
double max_cvar_m(const Gaussian& g, const World& world, double k);

/// INFREE of Alg. 1: whether (12) holds for every obstacle. Stops at the first that does not.
bool in_free(const Gaussian& g, const World& world, double k, double delta_m);

}  // namespace swarm
