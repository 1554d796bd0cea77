// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/quantile.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::monitor {
namespace {

/// The definition, by counting: the smallest value that at least a share q do not exceed.
double by_definition(const std::vector<double>& values, double q) {
  std::vector<double> fitting;
  for (const double candidate : values) {
    const auto not_above =
        std::count_if(values.begin(), values.end(), [&](double v) { return v <= candidate; });
    if (static_cast<double>(not_above) >= q * static_cast<double>(values.size())) {
      fitting.push_back(candidate);
    }
  }
  return *std::min_element(fitting.begin(), fitting.end());
}

TEST(Quantile, IsTheSmallestValueThatAShareDoesNotExceed) {
  Rng rng(5);
  for (int round = 0; round < 300; ++round) {
    std::vector<double> values(1 + rng() % 40);
    // Whole numbers, so that many values are equal.
    for (double& value : values) value = std::floor(uniform(rng, -6.0, 6.0));
    const double q = round % 3 == 0 ? 0.25 * static_cast<double>(rng() % 5) : uniform01(rng);

    const double expected = by_definition(values, q);

    EXPECT_EQ(quantile(values, q), expected) << "of " << values.size() << " values, q " << q;
  }
}

TEST(Quantile, IsAlwaysOneOfTheValues) {
  std::vector<double> values{3.0, 1.0, 2.0};
  EXPECT_EQ(quantile(values, 0.0), 1.0);
  EXPECT_EQ(quantile(values, 1.0 / 3.0), 1.0);
  EXPECT_EQ(quantile(values, 0.34), 2.0);
  EXPECT_EQ(quantile(values, 1.0), 3.0);
  std::vector<double> one{-7.5};
  for (const double q : {0.0, 0.5, 1.0}) EXPECT_EQ(quantile(one, q), -7.5);
}

TEST(Quantile, ReordersTheValuesAndKeepsAllOfThem) {
  Rng rng(6);
  std::vector<double> values(101);
  for (double& value : values) value = uniform(rng, 0.0, 1.0);
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());

  // In any order of the calls: each leaves the values partly sorted for the next.
  for (const double q : {0.99, 0.01, 0.5, 1.0, 0.0}) {
    const auto rank = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(q * 101.0)));
    EXPECT_EQ(quantile(values, q), sorted[rank - 1]) << q;
  }

  std::sort(values.begin(), values.end());
  EXPECT_EQ(values, sorted);
}

}  // namespace
}  // namespace swarm::monitor
