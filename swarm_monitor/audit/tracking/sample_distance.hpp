// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "swarmflow/core/mixture.hpp"

/// How far a swarm is from a mixture, and how far a perfect sample of that mixture would be.
namespace swarm::monitor {

/// n points of a mixture. How many come from each component is a systematic draw with a random
/// offset, u = (0 … n−1 + U)/n, so that every component has its n·ω points within one, and which
/// one rounds up differs from sample to sample as it differs from sample to swarm: with the same
/// rounding in both samples the floor would be too low by D/√n for a component D away.
std::vector<Vec2> fair_sample(const Mixture& mixture, std::size_t n, Rng& rng);

/// 2-Wasserstein distance of two sets of as many points: root of the mean squared distance of the
/// optimal assignment [m].
///
///   W₂ = (min_σ 1/n Σᵢ ‖aᵢ − b_σ(i)‖²)^½
///
/// O(n³) at worst; 0.012 to 0.025 s for n = 500. 0 of no points. \pre a.size() == b.size();
/// asserted
double w2_m(std::span<const Vec2> a, std::span<const Vec2> b);

/// W2 of points to a mixture beside its floor, each a mean over `draws` ≥ 2 samples.
struct Distance {
  double w2_m = 0.0;
  double floor_m = 0.0;  ///< of two independent samples to each other

  double ratio() const { return floor_m > 0.0 ? w2_m / floor_m : 1.0; }
};
Distance distance_to(const Mixture& mixture, std::span<const Vec2> points, std::size_t draws,
                     Rng& rng);

}  // namespace swarm::monitor
