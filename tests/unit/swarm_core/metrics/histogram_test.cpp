// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/metrics/histogram.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm {
namespace {

std::vector<std::int64_t> log_uniform_samples(std::size_t n, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<std::int64_t> samples;
  for (std::size_t i = 0; i < n; ++i) {
    samples.push_back(static_cast<std::int64_t>(std::exp(uniform(rng, 0.0, 22.0))));
  }
  return samples;
}

TEST(Histogram, IsEmptyAtFirst) {
  const Histogram histogram;

  EXPECT_EQ(histogram.count(), 0U);
  EXPECT_EQ(histogram.quantile_us(0.99), 0);
  EXPECT_EQ(histogram.max_us(), 0);
}

TEST(Histogram, CoversTheRangeWithoutGapsInBinsOfAtMostASixteenth) {
  std::int64_t bottom = 0;
  for (std::size_t bin = 0; bin < Histogram::kBins; ++bin) {
    const std::int64_t top = Histogram::top_us(bin);
    ASSERT_GE(top, bottom);
    // (Width − 1) / smallest value: the largest relative error of a quantile read at a bin's top.
    EXPECT_LE(static_cast<double>(top - bottom), 0.0625 * static_cast<double>(bottom));
    for (const std::int64_t value : {bottom, top}) {
      Histogram histogram;
      histogram.add(value);
      EXPECT_EQ(histogram.bin(bin), 1U) << value;
    }
    bottom = top + 1;
  }
  EXPECT_EQ(bottom, std::int64_t{1} << 32);
}

TEST(Histogram, KeepsQuantilesWithinSixAndAQuarterPercent) {
  auto samples = log_uniform_samples(20'000, 7);
  Histogram histogram;
  for (const std::int64_t sample : samples) histogram.add(sample);
  std::sort(samples.begin(), samples.end());

  for (const double q : {0.001, 0.1, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(q * 20'000.0)) - 1;
    const auto exact = static_cast<double>(samples[rank]);
    const auto read = static_cast<double>(histogram.quantile_us(q));
    EXPECT_GE(read, exact) << q;
    EXPECT_LE(read, exact * 1.0625 + 1.0) << q;
  }
  EXPECT_EQ(histogram.quantile_us(1.0), samples.back());
  EXPECT_EQ(histogram.max_us(), samples.back());
}

TEST(Histogram, MergesToTheHistogramOfAllSamples) {
  const auto samples = log_uniform_samples(1000, 3);
  Histogram all, even, odd;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    all.add(samples[i]);
    (i % 2 == 0 ? even : odd).add(samples[i]);
  }

  even.merge(odd);

  EXPECT_EQ(even.count(), all.count());
  EXPECT_EQ(even.max_us(), all.max_us());
  for (std::size_t i = 0; i < Histogram::kBins; ++i) EXPECT_EQ(even.bin(i), all.bin(i));
}

TEST(Histogram, ComesBackFromItsBins) {
  Histogram sent;
  for (const std::int64_t sample : log_uniform_samples(1000, 5)) sent.add(sample);

  Histogram received;
  for (std::size_t i = 0; i < Histogram::kBins; ++i) received.add_bin(i, sent.bin(i));

  EXPECT_EQ(received.count(), sent.count());
  EXPECT_EQ(received.quantile_us(0.5), sent.quantile_us(0.5));
  EXPECT_GE(received.max_us(), sent.max_us());
  EXPECT_LE(static_cast<double>(received.max_us()), 1.0625 * static_cast<double>(sent.max_us()));
}

TEST(Histogram, TakesValuesBeyondItsRange) {
  Histogram histogram;

  histogram.add(-5);
  histogram.add(std::int64_t{1} << 40);

  EXPECT_EQ(histogram.bin(0), 1U);
  EXPECT_EQ(histogram.bin(Histogram::kBins - 1), 1U);
  EXPECT_EQ(histogram.max_us(), std::int64_t{1} << 40);
}

}  // namespace
}  // namespace swarm
