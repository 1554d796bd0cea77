// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/metrics/assignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm {
namespace {

std::vector<double> random_costs(std::size_t n, Rng& rng) {
  std::vector<double> costs(n);
  for (double& cost : costs) cost = uniform(rng, 0.0, 300.0);
  return costs;
}

double by_all_permutations(const std::vector<double>& costs, std::size_t n) {
  std::vector<std::size_t> columns(n);
  std::iota(columns.begin(), columns.end(), 0);
  double best = std::numeric_limits<double>::infinity();
  do {
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) sum += costs[i * n + columns[i]];
    best = std::min(best, sum);
  } while (std::next_permutation(columns.begin(), columns.end()));
  return best;
}

TEST(Assignment, EqualsTheBestOfAllPermutations) {
  Rng rng(1);
  for (std::size_t n = 1; n <= 7; ++n) {
    for (int round = 0; round < 20; ++round) {
      const auto costs = random_costs(n * n, rng);
      // Each of the n costs is rounded to 1e-6.
      EXPECT_NEAR(assignment_cost(costs, n), by_all_permutations(costs, n), 1e-6 * 7);
    }
  }
}

TEST(Assignment, EqualsTheNetworkSimplex) {
  Rng rng(3);
  for (const std::size_t n : {2U, 30U, 150U}) {
    const std::vector<std::int64_t> ones(n, 1);
    for (int round = 0; round < 12; ++round) {
      std::vector<double> costs(n * n);
      for (double& cost : costs) {
        // Many equal ones, a wide range, a common range.
        cost = round % 3 == 0   ? std::floor(uniform(rng, 0.0, 4.0))
               : round % 3 == 1 ? uniform(rng, 0.0, 1e9)
                                : uniform(rng, 0.0, 100.0);
      }
      const double expected = transport_cost(costs, ones, ones);
      // It adds up whole costs of up to 1e15 as doubles.
      EXPECT_NEAR(assignment_cost(costs, n), expected, 1e-12 * expected) << n << " " << round;
    }
  }
}

TEST(Assignment, OfNothingCostsNothing) { EXPECT_EQ(assignment_cost({}, 0), 0.0); }

TEST(Transport, EqualsTheAssignmentOfItsUnits) {
  Rng rng(2);
  const std::vector<std::int64_t> supplies{3, 0, 2, 1};
  const std::vector<std::int64_t> demands{1, 4, 1};
  for (int round = 0; round < 20; ++round) {
    const auto costs = random_costs(12, rng);
    std::vector<double> unit_costs;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::int64_t u = 0; u < supplies[i]; ++u) {
        for (std::size_t j = 0; j < 3; ++j) {
          for (std::int64_t v = 0; v < demands[j]; ++v) unit_costs.push_back(costs[i * 3 + j]);
        }
      }
    }
    ASSERT_EQ(unit_costs.size(), 36U);
    EXPECT_NEAR(transport_cost(costs, supplies, demands), by_all_permutations(unit_costs, 6), 1e-5);
  }
}

}  // namespace
}  // namespace swarm
