// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/gaussian.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::test {

/// Means within 100 m of the origin, standard deviations 0.5–20 m, |ρ| ≤ 0.95.
inline Gaussian random_gaussian(Rng& rng) {
  const Vec2 mean(uniform(rng, -100.0, 100.0), uniform(rng, -100.0, 100.0));
  const double sigma1 = uniform(rng, 0.5, 20.0);
  const double sigma2 = uniform(rng, 0.5, 20.0);
  return Gaussian::from_parameters(mean, sigma1, sigma2, uniform(rng, -0.95, 0.95));
}

}  // namespace swarm::test
