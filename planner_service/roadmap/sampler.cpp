// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/sampler.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "planner_service/roadmap/means.hpp"
#include "planner_service/roadmap/squeeze.hpp"

namespace swarm::planner {
namespace {

// Tries without success after which the free space counts as full.
constexpr std::size_t kTriesPerSample = 2000;
// Where obstacles are small, few pairs straddle a border: after this many tries a plain mean is
// drawn instead.
constexpr std::size_t kBridgeTries = 1000;

// Uniform parameters [σ₁, σ₂, ρ] of a sample (eq. 8).
Gaussian with_random_shape(const Vec2& mean_m, const SamplerOptions& options, Rng& rng) {
  const double sigma1_m = uniform(rng, options.sigma_min_m, options.sigma_max_m);
  const double sigma2_m = uniform(rng, options.sigma_min_m, options.sigma_max_m);
  return Gaussian::from_parameters(mean_m, sigma1_m, sigma2_m,
                                   uniform(rng, -options.rho_max, options.rho_max));
}

// A random shape at a mean: squeezed into free space (kFit), or kept only if it is free as drawn.
std::optional<Gaussian> shaped_at(const Vec2& mean_m, const World& world, double k, double delta_m,
                                  const SamplerOptions& options, Rng& rng) {
  const Gaussian desired = with_random_shape(mean_m, options, rng);
  if (options.kind == SamplerKind::kFit) {
    return squeeze_into_free(desired, world, k, delta_m, kSqueezeBelowMin * options.sigma_min_m);
  }
  if (!in_free(desired, world, k, delta_m)) return std::nullopt;
  return desired;
}

// Morton order: the bits of column and row interleaved, so that cells near each other get near
// numbers.
std::uint32_t z_order(std::uint32_t column, std::uint32_t row, std::uint32_t bits) {
  std::uint32_t z = 0;
  for (std::uint32_t bit = 0; bit < bits; ++bit) {
    z |= ((column >> bit) & 1U) << (2 * bit) | ((row >> bit) & 1U) << (2 * bit + 1);
  }
  return z;
}

// Sorts samples by Morton order: neighbours in space become neighbours in memory, which speeds up
// the passes over pairs. Counting sort, stable.
std::vector<Gaussian> by_position(const std::vector<Gaussian>& samples, const Box& bounds_m) {
  std::uint32_t bits = 0;
  while (bits < 12 && (4ULL << (2 * bits)) <= samples.size()) ++bits;
  const std::uint32_t cells = 1U << bits;
  const Vec2 per_m = Vec2::Constant(cells).cwiseQuotient(bounds_m.max_m - bounds_m.min_m);
  std::vector<std::uint32_t> key;
  key.reserve(samples.size());
  std::vector<std::uint32_t> fill(std::size_t{cells} * cells + 1, 0);
  for (const Gaussian& sample : samples) {
    const Vec2 cell = (sample.mean_m() - bounds_m.min_m).cwiseProduct(per_m);
    key.push_back(z_order(std::min(static_cast<std::uint32_t>(cell.x()), cells - 1),
                          std::min(static_cast<std::uint32_t>(cell.y()), cells - 1), bits));
    ++fill[key.back() + 1];
  }
  for (std::size_t i = 1; i < fill.size(); ++i) fill[i] += fill[i - 1];
  std::vector<Gaussian> sorted(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) sorted[fill[key[i]]++] = samples[i];
  return sorted;
}

}  // namespace

std::optional<Gaussian> sample_at(const Vec2& mean_m, const World& world, const RiskLimit& risk,
                                  const SamplerOptions& options, Rng& rng) {
  return shaped_at(mean_m, world, cvar_coefficient(risk.alpha), risk.delta_m, options, rng);
}

std::vector<Gaussian> sample_free(const World& world, const RiskLimit& risk,
                                  const SamplerOptions& options, std::size_t count, Rng& rng) {
  const double k = cvar_coefficient(risk.alpha);
  // The narrowest Gaussian that may be sampled needs this much room, so that nearer means are
  // rejected at once.
  const double clearance_m = k * options.sigma_min_m - risk.delta_m;
  HaltonMeans halton(world.bounds_m(), rng);
  std::vector<Gaussian> samples;
  samples.reserve(count);
  for (std::size_t tries = 0; samples.size() < count && tries < kTriesPerSample; ++tries) {
    std::optional<Vec2> mean;
    // Decided by the samples found, not by the tries: those near obstacles fail more often.
    const auto found = static_cast<double>(samples.size());
    const bool bridge_turn =
        std::floor((found + 1.0) * options.bridge_share) > std::floor(found * options.bridge_share);
    if (bridge_turn && tries < kBridgeTries && !world.obstacles().empty()) {
      mean = near_obstacle_mean(world, options.bridge_sigma_m, clearance_m, rng);
      if (!mean) continue;
    } else {
      mean = options.kind == SamplerKind::kUniform ? uniform_mean(world.bounds_m(), rng)
                                                   : halton.next();
    }
    const auto sample = shaped_at(*mean, world, k, risk.delta_m, options, rng);
    if (!sample) continue;
    samples.push_back(*sample);
    tries = 0;
  }
  return by_position(samples, world.bounds_m());
}

}  // namespace swarm::planner
