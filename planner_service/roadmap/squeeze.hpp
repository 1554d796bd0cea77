// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "swarmflow/core/gaussian.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm::planner {

/// Makes a Gaussian keep CVaR ≤ δ at its mean by narrowing it towards the obstacles only:
///
///   Σ' = AΣA,  A = I − (1−q)nnᵀ,  q = (s(μ) + δ) / (k σₙ)
///
/// for the obstacle that violates the limit most, until none does. Nothing when the mean itself is
/// too near, or when a standard deviation would fall below `sigma_min_m`.
std::optional<Gaussian> squeeze_into_free(const Gaussian& g, const World& world, double k,
                                          double delta_m, double sigma_min_m);

/// Moves the mean away from the nearest obstacles until it is `room_m` from them; where there is
/// less room, as far as a few pushes take it.
Gaussian push_out(const Gaussian& g, const World& world, double room_m);

}  // namespace swarm::planner
