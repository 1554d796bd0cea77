// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/transport_lp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"
#include "tests/unit/planner_service/flow/lp_oracle.hpp"

namespace swarm::planner {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Tries every transport in whole units, cell by cell.
double cheapest(std::vector<int>& supply, std::vector<int>& demand,
                const std::vector<double>& costs, std::size_t cell) {
  const std::size_t columns = demand.size();
  if (cell == costs.size()) {
    const auto left = std::accumulate(supply.begin(), supply.end(), 0);
    return left == 0 ? 0.0 : kInfinity;
  }
  int& from = supply[cell / columns];
  int& to = demand[cell % columns];
  double best = kInfinity;
  for (int units = 0; units <= std::min(from, to); ++units) {
    if (units > 0 && std::isinf(costs[cell])) break;
    from -= units;
    to -= units;
    const double rest = cheapest(supply, demand, costs, cell + 1);
    best = std::min(best, (units > 0 ? units * costs[cell] : 0.0) + rest);
    from += units;
    to += units;
  }
  return best;
}

// `parts` positive whole numbers that sum to `total`.
std::vector<int> random_parts(Rng& rng, int parts, int total) {
  std::vector<int> out(static_cast<std::size_t>(parts), 1);
  for (int i = parts; i < total; ++i) ++out[rng() % out.size()];
  return out;
}

std::vector<double> shares(const std::vector<int>& units, int total) {
  std::vector<double> out;
  for (const int u : units) out.push_back(static_cast<double>(u) / total);
  return out;
}

TEST(TransportLp, IsAsCheapAsTheBestOfAllTransports) {
  // Vertices of a transport polytope with whole supplies and demands are whole: enumerating whole
  // transports finds the optimum.
  constexpr int kTotal = 8;
  Rng rng(1);
  int infeasible = 0;
  for (int round = 0; round < 300; ++round) {
    std::vector<int> supply = random_parts(rng, 1 + static_cast<int>(rng() % 3), kTotal);
    std::vector<int> demand = random_parts(rng, 1 + static_cast<int>(rng() % 3), kTotal);
    std::vector<double> costs(supply.size() * demand.size());
    for (double& cost : costs) cost = uniform01(rng) < 0.2 ? kInfinity : uniform(rng, 1.0, 300.0);
    const double best = cheapest(supply, demand, costs, 0) / kTotal;

    const auto shipments = solve_transport(shares(supply, kTotal), shares(demand, kTotal), costs);

    ASSERT_EQ(shipments.has_value(), std::isfinite(best));
    if (!shipments) {
      ++infeasible;
      continue;
    }
    double cost = 0.0;
    std::vector<double> out(supply.size(), 0.0);
    std::vector<double> in(demand.size(), 0.0);
    for (const Shipment& s : *shipments) {
      EXPECT_GT(s.mass, 0.0);
      cost += s.mass * costs[s.from * demand.size() + s.to];
      out[s.from] += s.mass;
      in[s.to] += s.mass;
    }
    EXPECT_NEAR(cost, best, 1e-12 * best);  // rounding of the sums: eighths are whole units
    for (std::size_t i = 0; i < out.size(); ++i) EXPECT_DOUBLE_EQ(out[i], supply[i] / 8.0);
    for (std::size_t j = 0; j < in.size(); ++j) EXPECT_DOUBLE_EQ(in[j], demand[j] / 8.0);
    EXPECT_LE(shipments->size(), supply.size() + demand.size() - 1);  // basic
  }
  EXPECT_GT(infeasible, 10);
}

TEST(TransportLp, EqualsALinearProgramOnWeightsOfAnyKind) {
  Rng rng(2);
  for (int round = 0; round < 200; ++round) {
    std::vector<double> supply(2 + rng() % 7);
    std::vector<double> demand(2 + rng() % 7);
    for (std::vector<double>* masses : {&supply, &demand}) {
      double sum = 0.0;
      for (double& mass : *masses) sum += mass = uniform(rng, 1e-3, 1.0);
      for (double& mass : *masses) mass /= sum;
    }
    std::vector<double> costs(supply.size() * demand.size());
    for (double& cost : costs) cost = uniform01(rng) < 0.1 ? kInfinity : uniform(rng, 1.0, 300.0);
    test::LinearProgram lp;
    for (const double mass : supply) lp.add_row(mass, mass);
    for (const double mass : demand) lp.add_row(mass, mass);
    for (std::size_t cell = 0; cell < costs.size(); ++cell) {
      if (std::isinf(costs[cell])) continue;
      lp.add_column(costs[cell], {{static_cast<int>(cell / demand.size()), 1.0},
                                  {static_cast<int>(supply.size() + cell % demand.size()), 1.0}});
    }
    const auto best = lp.minimum();

    const auto shipments = solve_transport(supply, demand, costs);

    ASSERT_EQ(shipments.has_value(), best.has_value());
    if (!shipments) continue;
    double cost = 0.0;
    for (const Shipment& s : *shipments) cost += s.mass * costs[s.from * demand.size() + s.to];
    EXPECT_NEAR(cost, *best, 1e-9 * *best);
  }
}

TEST(TransportLp, ClosesTheSumsOfThirds) {
  const std::vector<double> thirds{1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0};
  const std::vector<double> sevenths(7, 1.0 / 7.0);
  const std::vector<double> costs(21, 1.0);

  const auto shipments = solve_transport(thirds, sevenths, costs);

  ASSERT_TRUE(shipments.has_value());
  double sum = 0.0;
  for (const Shipment& s : *shipments) sum += s.mass;
  EXPECT_NEAR(sum, 1.0, 1e-14);  // each weight is rounded to 2⁻⁵⁰ = 9e-16
}

TEST(TransportLp, AcceptsPathsThatCostNothing) {
  const std::vector<double> one{1.0};
  const std::vector<double> free_path{0.0};

  const auto shipments = solve_transport(one, one, free_path);

  ASSERT_TRUE(shipments.has_value());
  ASSERT_EQ(shipments->size(), 1U);
  EXPECT_EQ((*shipments)[0].mass, 1.0);
}

TEST(TransportLp, NamesThePairsThatNoRouteJoins) {
  const double none = std::numeric_limits<double>::infinity();
  const std::vector<double> costs_m{1.0, none, 2.0, none, none, 3.0};  // two starts, three goals

  EXPECT_EQ(unjoined_pairs(costs_m, 3), "0 -> 1, 1 -> 0, 1 -> 1");
  EXPECT_EQ(unjoined_pairs(std::vector<double>{1.0}, 1), "");
}

}  // namespace
}  // namespace swarm::planner
