// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/sample_distance.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

namespace swarm::monitor {
namespace {

Gaussian round_gaussian(const Vec2& mean_m, double sigma_m) {
  return Gaussian::from_valid(mean_m, sigma_m * sigma_m * Mat2::Identity());
}

Mixture mixture_of(std::vector<WeightedGaussian> components) {
  auto mixture = Mixture::make(std::move(components));
  EXPECT_TRUE(mixture.has_value());
  return mixture.value_or(Mixture{});
}

TEST(SampleDistance, IsTheBestOfAllPermutations) {
  Rng rng(3);
  for (int round = 0; round < 20; ++round) {
    std::vector<Vec2> a, b;
    for (int i = 0; i < 6; ++i) {
      a.emplace_back(uniform(rng, 0, 10), uniform(rng, 0, 10));
      b.emplace_back(uniform(rng, 0, 10), uniform(rng, 0, 10));
    }
    std::vector<std::size_t> order(6);
    std::iota(order.begin(), order.end(), 0);
    double least = 1e300;
    do {
      double sum = 0.0;
      for (std::size_t i = 0; i < 6; ++i) sum += (a[i] - b[order[i]]).squaredNorm();
      least = std::min(least, std::sqrt(sum / 6.0));
    } while (std::next_permutation(order.begin(), order.end()));

    EXPECT_NEAR(w2_m(a, b), least, 1e-5);  // costs are rounded to 1e-6 m²
  }
}

TEST(SampleDistance, OfAShiftedSetIsTheShift) {
  Rng rng(4);
  const auto points = fair_sample(mixture_of({{1.0, round_gaussian({5, 5}, 3.0)}}), 200, rng);
  std::vector<Vec2> shifted = points;
  for (Vec2& p : shifted) p += Vec2(3.0, -4.0);

  EXPECT_NEAR(w2_m(points, shifted), 5.0, 1e-6);
  EXPECT_EQ(w2_m({}, {}), 0.0);
}

TEST(SampleDistance, DrawsEachComponentsShareWithinOne) {
  const Mixture mixture = mixture_of({{0.1875, round_gaussian({0, 0}, 1.0)},
                                      {0.3125, round_gaussian({1000, 0}, 1.0)},
                                      {0.5, round_gaussian({2000, 0}, 1.0)}});
  Rng rng(5);
  double first = 0.0;
  bool low = false, high = false;
  constexpr int kRounds = 400;
  for (int round = 0; round < kRounds; ++round) {
    std::array<int, 3> counts{};
    for (const Vec2& p : fair_sample(mixture, 100, rng)) {
      ++counts[static_cast<std::size_t>(std::lround(p.x() / 1000.0))];
    }
    EXPECT_TRUE(counts[0] == 18 || counts[0] == 19) << counts[0];
    EXPECT_TRUE(counts[1] == 31 || counts[1] == 32) << counts[1];
    EXPECT_EQ(counts[2], 50);
    first += counts[0] / static_cast<double>(kRounds);
    low = low || counts[0] == 18;
    high = high || counts[0] == 19;
  }
  // 18.75 within five standard errors of a coin of 0.75: 5 · 0.433/20.
  EXPECT_NEAR(first, 18.75, 0.11);
  EXPECT_TRUE(low && high) << "the rounding differs from sample to sample";
}

TEST(SampleDistance, OfAFairSampleIsItsFloor) {
  const Mixture mixture =
      mixture_of({{0.3, round_gaussian({0, 0}, 2.0)}, {0.7, round_gaussian({40, 10}, 4.0)}});
  Rng rng(6);
  double w2 = 0.0, floor = 0.0;
  for (int round = 0; round < 60; ++round) {
    const auto swarm = fair_sample(mixture, 80, rng);
    const Distance distance = distance_to(mixture, swarm, 2, rng);
    w2 += distance.w2_m;
    floor += distance.floor_m;
  }
  // Both are means of 120 and 60 draws of the same distribution: a standard error of about 3 %.
  EXPECT_NEAR(w2 / floor, 1.0, 0.09);
}

TEST(SampleDistance, GrowsWithAShiftAsTheClosedForm) {
  const Mixture mixture = mixture_of({{1.0, round_gaussian({0, 0}, 2.0)}});
  Rng rng(7);
  auto swarm = fair_sample(mixture, 150, rng);
  for (Vec2& p : swarm) p.x() += 30.0;

  // W₂² = shift² + that of the samples, whose means differ by 2/√75 m or so.
  const Distance distance = distance_to(mixture, swarm, 4, rng);

  EXPECT_NEAR(distance.w2_m, 30.0, 1.0);
  EXPECT_LT(distance.floor_m, 1.5);
}

}  // namespace
}  // namespace swarm::monitor
