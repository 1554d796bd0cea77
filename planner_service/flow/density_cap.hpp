// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <span>

#include "swarmflow/core/gaussian.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm::planner {

/// An upper limit ρ on the density of a swarm of N robots.
struct DensityCap {
  double max_per_m2 = 0.0;  ///< ρ [robots/m²]
  double robots = 0.0;      ///< N
};

/// Share of the swarm that a Gaussian may carry alone: its peak density is N w / (2π √det Σ) ≤ ρ.
/// On a W₂ geodesic Σ(t) = AΣ_aA with A linear in t, so √det A is concave (Minkowski): √det Σ(t)
/// never falls below the smaller end value, so a leg keeps the cap if both ends do.
inline double mass_capacity(const Gaussian& g, const DensityCap& cap) {
  return 2.0 * std::numbers::pi * cap.max_per_m2 * std::sqrt(g.determinant()) / cap.robots;
}

/// Peak density of a Gaussian that carries a share of the swarm [robots/m²].
inline double peak_density_per_m2(const Gaussian& g, double mass, double robots) {
  return robots * mass / (2.0 * std::numbers::pi * std::sqrt(g.determinant()));
}

/// kInfeasible names the start and goal components that are denser than the cap by themselves, or
/// together where they overlap.
/// `nodes` begins with the start components, the goal components follow. \pre cap > 0, robots > 0
Result<void> check_components(std::span<const Gaussian> nodes, std::span<const double> supplies,
                              std::span<const double> demands, const DensityCap& cap);

}  // namespace swarm::planner
