// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "swarmflow/core/cvar.hpp"
#include "swarmflow/core/gaussian.hpp"
#include "swarmflow/core/random.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::planner {

/// How SAMPLEFREE finds Gaussians in free space.
enum class SamplerKind {
  kUniform,  ///< uniform means; a Gaussian that violates the risk limit is rejected (Alg. 1 as
             ///< printed)
  kHalton,   ///< Halton means, evenly spread; rejected likewise
  kFit,      ///< Halton means; it is squeezed along the obstacle's normal instead
};

/// Distribution of the samples.
struct SamplerOptions {
  SamplerKind kind = SamplerKind::kFit;
  double sigma_min_m = 1.0;  ///< range of σ₁ and σ₂
  double sigma_max_m = 3.0;
  double rho_max = 0.6;       ///< range of |ρ|
  double bridge_share = 0.3;  ///< share of means drawn near obstacles, see near_obstacle_mean()
  double bridge_sigma_m = 10.0;
};

/// A squeezed Gaussian may be this much narrower than σ_min before it counts as too narrow.
inline constexpr double kSqueezeBelowMin = 0.8;

/// One try of SAMPLEFREE at a given mean: a Gaussian of random shape that keeps the risk limit
/// (12), squeezed if need be when the kind is kFit.
std::optional<Gaussian> sample_at(const Vec2& mean_m, const World& world, const RiskLimit& risk,
                                  const SamplerOptions& options, Rng& rng);

/// SAMPLEFREE of SwarmPRM, Alg. 1: Gaussians [x, y, σ₁, σ₂, ρ] (eq. 8) that keep the risk limit
/// (12). Returns fewer than `count` when free space is so scarce that 2000 tries a sample do not
/// find it. Ordered by position, not by when they were drawn.
std::vector<Gaussian> sample_free(const World& world, const RiskLimit& risk,
                                  const SamplerOptions& options, std::size_t count, Rng& rng);

}  // namespace swarm::planner
