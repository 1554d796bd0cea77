// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/metrics/assignment.hpp"

#include <cmath>
#include <numeric>
#include <vector>

// LEMON's templates alone: its library is not linked.
#define LEMON_ONLY_TEMPLATES
#include <lemon/network_simplex.h>
#include <lemon/smart_graph.h>

#include "swarm_core/base/assert.hpp"

namespace swarm {
namespace {

constexpr double kUnitsPerCost = 1e6;
constexpr double kMaxCost = 1e9;

}  // namespace

double transport_cost(std::span<const double> costs, std::span<const std::int64_t> supplies,
                      std::span<const std::int64_t> demands) {
  SWARM_ASSERT(costs.size() == supplies.size() * demands.size());
  SWARM_ASSERT(std::accumulate(supplies.begin(), supplies.end(), std::int64_t{0}) ==
               std::accumulate(demands.begin(), demands.end(), std::int64_t{0}));
  if (costs.empty()) return 0.0;
  using Graph = lemon::SmartDigraph;
  const int rows = static_cast<int>(supplies.size());
  const int columns = static_cast<int>(demands.size());
  Graph graph;
  graph.reserveNode(rows + columns);
  graph.reserveArc(static_cast<int>(costs.size()));
  for (int i = 0; i < rows + columns; ++i) graph.addNode();
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      graph.addArc(Graph::nodeFromId(i), Graph::nodeFromId(rows + j));
    }
  }
  Graph::ArcMap<std::int64_t> cost(graph);
  for (std::size_t k = 0; k < costs.size(); ++k) {
    SWARM_ASSERT(costs[k] >= 0.0 && costs[k] <= kMaxCost);
    cost[Graph::arcFromId(static_cast<int>(k))] = std::llround(costs[k] * kUnitsPerCost);
  }
  Graph::NodeMap<std::int64_t> supply(graph);
  for (int i = 0; i < rows; ++i) {
    supply[Graph::nodeFromId(i)] = supplies[static_cast<std::size_t>(i)];
  }
  for (int j = 0; j < columns; ++j) {
    supply[Graph::nodeFromId(rows + j)] = -demands[static_cast<std::size_t>(j)];
  }
  lemon::NetworkSimplex<Graph, std::int64_t, std::int64_t> simplex(graph);
  simplex.costMap(cost).supplyMap(supply);
  SWARM_ASSERT(simplex.run() == decltype(simplex)::OPTIMAL);
  return simplex.totalCost<double>() / kUnitsPerCost;
}

double assignment_cost(std::span<const double> costs, std::size_t n) {
  SWARM_ASSERT(costs.size() == n * n);
  const std::vector<std::int64_t> ones(n, 1);
  return transport_cost(costs, ones, ones);
}

}  // namespace swarm
