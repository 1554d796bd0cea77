// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/transport/transport_lp.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

// The library's compiled part is not needed and not linked.
#define LEMON_ONLY_TEMPLATES
#include <lemon/network_simplex.h>
#include <lemon/smart_graph.h>

#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

using Units = std::int64_t;
using Graph = lemon::SmartDigraph;

constexpr Units kMassUnits = 1'000'000'000;
// Total cost stays below 1e9 · 1e8 = 1e17, well within 64 bits.
constexpr double kCostUnits = 1e8;

// Rounds so that the sum is exactly kMassUnits; the largest takes what rounding leaves.
std::vector<Units> in_units(std::span<const double> masses) {
  std::vector<Units> units;
  for (const double mass : masses) {
    SWARM_ASSERT(mass > 0.0);
    units.push_back(std::max<Units>(1, std::llround(mass * static_cast<double>(kMassUnits))));
  }
  *std::max_element(units.begin(), units.end()) +=
      kMassUnits - std::accumulate(units.begin(), units.end(), Units{0});
  return units;
}

}  // namespace

std::optional<std::vector<Shipment>> solve_transport(std::span<const double> supplies,
                                                     std::span<const double> demands,
                                                     std::span<const double> costs_m) {
  SWARM_ASSERT(costs_m.size() == supplies.size() * demands.size());
  const std::vector<Units> supply_units = in_units(supplies);
  const std::vector<Units> demand_units = in_units(demands);
  double largest_m = 0.0;
  for (const double cost_m : costs_m) {
    if (std::isfinite(cost_m)) largest_m = std::max(largest_m, cost_m);
  }
  const double scale = largest_m > 0.0 ? kCostUnits / largest_m : 0.0;

  Graph graph;
  Graph::NodeMap<Units> supply(graph);
  Graph::ArcMap<Units> cost(graph);
  for (const Units units : supply_units) supply[graph.addNode()] = units;
  for (const Units units : demand_units) supply[graph.addNode()] = -units;
  std::vector<Shipment> candidates;
  for (std::size_t i = 0; i < supplies.size(); ++i) {
    for (std::size_t j = 0; j < demands.size(); ++j) {
      const double cost_m = costs_m[i * demands.size() + j];
      if (!std::isfinite(cost_m)) continue;
      const Graph::Arc arc = graph.addArc(Graph::nodeFromId(static_cast<int>(i)),
                                          Graph::nodeFromId(static_cast<int>(supplies.size() + j)));
      cost[arc] = std::llround(cost_m * scale);
      candidates.push_back({i, j, 0.0});
    }
  }

  lemon::NetworkSimplex<Graph, Units, Units> simplex(graph);
  simplex.supplyMap(supply).costMap(cost);
  if (simplex.run() != decltype(simplex)::OPTIMAL) return std::nullopt;
  std::vector<Shipment> shipments;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Units flow = simplex.flow(Graph::arcFromId(static_cast<int>(i)));
    if (flow == 0) continue;
    candidates[i].mass = static_cast<double>(flow) / static_cast<double>(kMassUnits);
    shipments.push_back(candidates[i]);
  }
  return shipments;
}

}  // namespace swarm::planner
