// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/world.hpp"

/// CVaR of a whole mixture near one obstacle. A limit on it is weaker than the same limit on every
/// single Gaussian: a small part of the swarm may pass closer to the obstacle.
namespace swarm {

/// A component Yʲ ~ N(mean, sigma²) of a mixture Y on the line.
struct LineComponent {
  double weight = 0.0;  ///< ωⱼ ≥ 0
  double mean_m = 0.0;
  double sigma_m = 1.0;  ///< > 0
};

/// Value at risk of a loss Y at level α, and the mean of Y beyond it.
struct TailRisk {
  double var_m = 0.0;  ///< VaR_α(Y): exceeded with probability α                    [ROVER, eq. 6]
  double cvar_m = 0.0;  ///< CVaR_α(Y): mean of what exceeds it                      [ROVER, eq. 15]
};

/// VaR by VARSEARCH (Newton on the tail probability, kept inside a bracket), and
///
///   CVaR_α(Y) = VaR + 1/α Σ ωⱼ E[(Yʲ − VaR)⁺]       (eq. 15 for Σω = 1, since α = Σ ωⱼαⱼ)
///
/// which is the minimum over z of eq. 25 for any weights, so it may be differentiated in them.
/// O(components · rounds), about ten rounds. \pre 0 < α < Σω; some weight positive
TailRisk mixture_tail_risk(std::span<const LineComponent> components, double alpha);

/// Gradient of the CVaR in the weights, written to `gradient_m` [ROVER, eq. 18]:
///
///   ∂CVaR_α(Y)/∂ωⱼ = αⱼ/α (CVaR_{αⱼ}(Yʲ) − VaR_α(Y)) = 1/α E[(Yʲ − VaR)⁺]
///
/// CVaR is concave in ω, so its first-order expansion is never below it [ROVER, eq. 22].
/// \pre gradient_m.size() == components.size(), asserted
void mixture_cvar_gradient(std::span<const LineComponent> components, double alpha, double var_m,
                           std::span<double> gradient_m);

/// Y = −sd(X, O) of a mixture X and one convex obstacle [ROVER, eq. 14].
std::vector<LineComponent> negated_distance(const Mixture& mixture, const ConvexObstacle& obstacle);

/// Largest CVaR_α(−sd(X, O)) over the obstacles of the world [m], each by mixture_tail_risk(); −∞
/// without obstacles. The risk limit (11g) of ROVER holds iff the result is at most ε, key
/// `planner.risk_delta_m`.
double max_mixture_cvar_m(const Mixture& mixture, const World& world, double alpha);

}  // namespace swarm
