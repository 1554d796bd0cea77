// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/min_cost_flow.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"
#include "tests/unit/planner_service/flow/lp_oracle.hpp"

namespace swarm::planner {
namespace {

struct Network {
  std::vector<double> balance;
  std::vector<FlowArc> arcs;
};

// Three sources and sinks of masses that no power of two divides, some arcs without a capacity.
Network random_network(Rng& rng) {
  constexpr std::size_t kNodes = 14;
  Network net;
  net.balance.assign(kNodes, 0.0);
  double out = 0.0;
  for (std::size_t i = 0; i < 3; ++i) out += net.balance[i] = uniform(rng, 0.1, 1.0);
  for (double& mass : net.balance) mass /= out;
  net.balance[kNodes - 1] = -0.3;
  net.balance[kNodes - 2] = -0.2;
  net.balance[kNodes - 3] = -0.5;
  const double largest_cost = std::pow(10.0, uniform(rng, -3.0, 4.0));
  for (int a = 0; a < 45; ++a) {
    const auto from = static_cast<std::uint32_t>(rng() % kNodes);
    const auto to = static_cast<std::uint32_t>(rng() % kNodes);
    if (from == to) continue;
    net.arcs.push_back({.from = from, .to = to, .cost = uniform(rng, 0.0, largest_cost)});
    if (uniform01(rng) < 0.7) net.arcs.back().capacity = uniform(rng, 0.05, 0.8);
  }
  return net;
}

std::optional<double> optimum(const Network& net) {
  test::LinearProgram lp;
  for (const double balance : net.balance) lp.add_row(balance, balance);
  for (const FlowArc& arc : net.arcs) {
    lp.add_column(arc.cost, {{static_cast<int>(arc.from), 1.0}, {static_cast<int>(arc.to), -1.0}},
                  arc.capacity);
  }
  return lp.minimum();
}

TEST(MinCostFlow, IsAsCheapAsALinearProgram) {
  Rng rng(1);
  int feasible = 0;
  int infeasible = 0;
  for (int round = 0; round < 300; ++round) {
    const Network net = random_network(rng);
    const auto best = optimum(net);

    const auto flow = min_cost_flow(net.balance, net.arcs);

    ASSERT_EQ(flow.has_value(), best.has_value()) << "round " << round;
    if (!flow) {
      ++infeasible;
      continue;
    }
    ++feasible;
    double cost = 0.0;
    std::vector<double> left = net.balance;
    for (std::size_t a = 0; a < net.arcs.size(); ++a) {
      const double x = (*flow)[a];
      EXPECT_GE(x, 0.0);
      EXPECT_LE(x, net.arcs[a].capacity + 1e-15);  // one unit of mass
      cost += x * net.arcs[a].cost;
      left[net.arcs[a].from] -= x;
      left[net.arcs[a].to] += x;
    }
    for (const double rest : left) EXPECT_NEAR(rest, 0.0, 1e-11);  // negligible flow of some arcs
    EXPECT_NEAR(cost, *best, 1e-9 * *best);
  }
  EXPECT_GT(feasible, 50);
  EXPECT_GT(infeasible, 50);
}

TEST(MinCostFlow, LeavesOutWhatOnlyRoundingSends) {
  // 0.1 + 0.2 is not 0.3: the difference of 5e-17 would take a path of its own.
  const std::vector<double> balance{0.1 + 0.2, 0.7, -0.3, -0.7};
  const std::vector<FlowArc> arcs{{.from = 0, .to = 2, .cost = 1.0},
                                  {.from = 1, .to = 3, .cost = 1.0},
                                  {.from = 0, .to = 3, .cost = 5.0},
                                  {.from = 1, .to = 2, .cost = 5.0}};

  const auto flow = min_cost_flow(balance, arcs);

  ASSERT_TRUE(flow.has_value());
  EXPECT_EQ((*flow)[2], 0.0);
  EXPECT_EQ((*flow)[3], 0.0);
  EXPECT_NEAR((*flow)[0], 0.3, 1e-15);
}

}  // namespace
}  // namespace swarm::planner
