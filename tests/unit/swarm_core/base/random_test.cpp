// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/random.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace swarm {
namespace {

// The first numbers of the published SplitMix64 generator with seed 0.
TEST(MixSeed, IsSplitMix64) {
  EXPECT_EQ(mix_seed(0, 0), 0xE220A8397B1DCDAFULL);
  EXPECT_EQ(mix_seed(0, 1), 0x6E789E6AA1B965F4ULL);
  EXPECT_EQ(mix_seed(0, 2), 0x06C45D188009454FULL);
  EXPECT_EQ(mix_seed(0, 3), 0xF88BB8A8724C81ECULL);
}

TEST(MixSeed, GivesSmallIntegersSeedsOfTheirOwn) {
  std::vector<std::uint64_t> seeds;
  for (std::uint64_t a = 0; a < 300; ++a) {
    for (std::uint64_t b = 0; b < 300; ++b) seeds.push_back(mix_seed(a, b));
  }
  std::sort(seeds.begin(), seeds.end());

  EXPECT_EQ(std::adjacent_find(seeds.begin(), seeds.end()), seeds.end());
}

// Avalanche: a change of one bit of a seed changes half of the bits, within 5 σ of 64 fair coins
// over 200 trials.
TEST(MixSeed, SpreadsEveryBit) {
  Rng rng(1);
  for (int bit = 0; bit < 64; ++bit) {
    int changed = 0;
    for (int i = 0; i < 200; ++i) {
      const std::uint64_t a = rng(), b = rng() % 1000;
      changed += std::popcount(mix_seed(a, b) ^ mix_seed(a ^ (1ULL << bit), b));
    }
    EXPECT_NEAR(changed / 200.0, 32.0, 5 * 4.0 / std::sqrt(200.0)) << bit;
  }
}

TEST(Uniform01, IsNeverOne) {
  // 53 ones are the largest number below 1.
  EXPECT_EQ(static_cast<double>(~0ULL >> 11U) * 0x1.0p-53,
            1.0 - std::numeric_limits<double>::epsilon() / 2);
  Rng rng(2);
  for (int i = 0; i < 100'000; ++i) {
    const double u = uniform01(rng);
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
  }
}

// χ² of 100 bins with 99 degrees of freedom: below 160 in all but 1 of 10 000 fair generators.
TEST(Uniform01, FillsItsIntervalEvenly) {
  Rng rng(3);
  std::array<int, 100> bins{};
  constexpr int kDraws = 100'000;
  for (int i = 0; i < kDraws; ++i) ++bins[static_cast<std::size_t>(100 * uniform01(rng))];
  double chi2 = 0.0;
  for (const int n : bins) chi2 += (n - 1000.0) * (n - 1000.0) / 1000.0;

  EXPECT_LT(chi2, 160.0);
}

TEST(Uniform, LiesInItsIntervalAndIsItsLowerEndIfEmpty) {
  Rng rng(4);
  for (int i = 0; i < 10'000; ++i) {
    const double x = uniform(rng, -3.0, 5.0);
    ASSERT_GE(x, -3.0);
    ASSERT_LT(x, 5.0);
  }
  EXPECT_EQ(uniform(rng, 7.0, 7.0), 7.0);
}

// Runs are compared by digests, so a draw advances the generator by a fixed number of steps.
TEST(Draws, TakeTheStatedNumberOfSteps) {
  Rng rng(5), once(5), twice(5);
  once.discard(1);
  twice.discard(2);

  Rng a = rng;
  uniform01(a);
  EXPECT_EQ(a, once);
  Rng b = rng;
  uniform(b, 1, 2);
  EXPECT_EQ(b, once);
  Rng c = rng;
  standard_normal(c);
  EXPECT_EQ(c, twice);
}

// Moments of 10⁶ draws, within 5 standard errors; and the tail, whose share beyond 3 is 0.27 %.
TEST(StandardNormal, HasTheMomentsAndTailOfItsDistribution) {
  Rng rng(6);
  constexpr int kDraws = 1'000'000;
  double sum = 0, squares = 0, cubes = 0, fourths = 0;
  int beyond = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = standard_normal(rng);
    ASSERT_TRUE(std::isfinite(x));
    sum += x;
    squares += x * x;
    cubes += x * x * x;
    fourths += x * x * x * x;
    beyond += std::abs(x) > 3.0 ? 1 : 0;
  }

  EXPECT_NEAR(sum / kDraws, 0.0, 5e-3);
  EXPECT_NEAR(squares / kDraws, 1.0, 5 * 1.41e-3);
  EXPECT_NEAR(cubes / kDraws, 0.0, 5 * 3.9e-3);
  EXPECT_NEAR(fourths / kDraws, 3.0, 5 * 9.8e-3);
  EXPECT_NEAR(beyond, 2700, 5 * 52);
}

}  // namespace
}  // namespace swarm
