// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace swarm {

/// The random generator, passed by reference into all code that draws. There is no global one, so
/// the same seed gives the same run.
using Rng = std::mt19937_64;

/// SplitMix64 finaliser of two numbers: decorrelates seeds built from small integers (seed, robot
/// id, plan version). Nest it for more than two: mix_seed(mix_seed(a, b), c).
constexpr std::uint64_t mix_seed(std::uint64_t a, std::uint64_t b = 0) {
  std::uint64_t z = a + 0x9E3779B97F4A7C15ULL * (b + 1);
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31U);
}

/// Uniform on [0, 1) with 53 random bits, the same on every standard library. Draws once.
inline double uniform01(Rng& rng) { return static_cast<double>(rng() >> 11U) * 0x1.0p-53; }

/// Uniform on [low, high). Draws once. \pre low ≤ high; not checked
inline double uniform(Rng& rng, double low, double high) {
  return low + (high - low) * uniform01(rng);
}

/// Standard normal by Box–Muller, the same on every standard library (std::normal_distribution is
/// not). Draws twice.
inline double standard_normal(Rng& rng) {
  const double u = 1.0 - uniform01(rng);
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * uniform01(rng));
}

}  // namespace swarm
