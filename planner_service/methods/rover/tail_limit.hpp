// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "swarm_core/risk/mixture_cvar.hpp"

/// The GMM-CVaR constraint (11g), CVaR_α(Y) ≤ ε for Y = −sd(X, O), in the form the linear programs
/// use.
///
/// Since CVaR_α(Y) = min_z z + Σ ωⱼ E[(Yʲ − z)⁺]/α, every z < ε gives a constraint that is linear
/// in the weights and implies (11g):
///
///   Σ ωⱼ ρⱼ(z) ≤ α,   ρⱼ(z) = E[(Yʲ − z)⁺] / (ε − z)                                         (R)
///
/// With z = VaR_α(Y) it is the paper's linearisation (22), which touches (11g) at the weights where
/// it was made. Where these keep (11g) with slack, the z that admits most of them, ω times the
/// largest factor, is better: it touches (11g) where the ray through ω meets it. That z cuts off
/// the tail whose mean is ε, and (11g) holds exactly when the tail's probability is at most α.
namespace swarm::planner {

struct TailAtLimit {
  double from_m = 0.0;       ///< z with E[Y | Y > z] = ε
  double probability = 0.0;  ///< P(Y > z); CVaR_α(Y) ≤ ε iff it is at most α
};

/// Newton on (ε − z) P(Y > z) − E[(Y − z)⁺], which falls with z, kept inside a bracket.
/// O(components · rounds). Components may be left out that are too far to matter, so the weights
/// need not sum to 1. Probability 0 when there is none; P(all) when even the mean of all exceeds ε,
/// with a z far below.
TailAtLimit tail_at_limit(std::span<const LineComponent> components, double epsilon_m);

/// ρ(z) of (R) for one component. \pre z < ε
double risk_share(const LineComponent& component, double z_m, double epsilon_m);

}  // namespace swarm::planner
