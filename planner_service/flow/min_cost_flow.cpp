// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/min_cost_flow.hpp"

#include <algorithm>
#include <cmath>
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

// The whole supply in units. Sums of supplies stay far below 2⁶³.
constexpr Units kMassUnits = Units{1} << 50;
// The solver starts from potentials of 2⁶² and adds costs along paths of at most all nodes to them.
constexpr double kPathUnits = 0x1p60;
// Costs keep the precision of a double's mantissa and no more.
constexpr double kFinestCost = 0x1p52;

// The largest cost sets the unit of costs.
double largest_cost(std::span<const FlowArc> arcs) {
  double largest = 0.0;
  for (const FlowArc& arc : arcs) largest = std::max(largest, arc.cost);
  return largest;
}

// Rounds so that the sum is exactly 0; the largest takes what rounding leaves.
std::vector<Units> in_units(std::span<const double> supplies, double per_unit) {
  std::vector<Units> units;
  units.reserve(supplies.size());
  for (const double supply : supplies) units.push_back(std::llround(supply * per_unit));
  *std::max_element(units.begin(), units.end()) -=
      std::accumulate(units.begin(), units.end(), Units{0});
  return units;
}

}  // namespace

// Whole numbers make the network simplex exact: with floating point, rounding in potentials could
// make it cycle or stop early. Masses and costs are scaled to units, solved, and scaled back.
std::optional<std::vector<double>> min_cost_flow(std::span<const double> supplies,
                                                 std::span<const FlowArc> arcs) {
  double total = 0.0;
  for (const double supply : supplies) total += std::max(0.0, supply);
  SWARM_ASSERT(total > 0.0);
  const double per_unit = static_cast<double>(kMassUnits) / total;
  const double largest = largest_cost(arcs);
  const double finest =
      std::min(kFinestCost, kPathUnits / static_cast<double>(supplies.size() + 2));
  const double cost_scale = largest > 0.0 ? finest / largest : 0.0;

  Graph graph;
  graph.reserveNode(static_cast<int>(supplies.size()));
  graph.reserveArc(static_cast<int>(arcs.size()));
  Graph::NodeMap<Units> supply(graph);
  Graph::ArcMap<Units> cost(graph);
  Graph::ArcMap<Units> capacity(graph);
  for (const Units units : in_units(supplies, per_unit)) supply[graph.addNode()] = units;
  for (const FlowArc& arc : arcs) {
    const Graph::Arc added = graph.addArc(Graph::nodeFromId(static_cast<int>(arc.from)),
                                          Graph::nodeFromId(static_cast<int>(arc.to)));
    SWARM_ASSERT(arc.cost >= 0.0 && arc.capacity >= 0.0);
    cost[added] = std::llround(arc.cost * cost_scale);
    // An arc never carries more than the whole supply, since costs are not negative. A larger
    // capacity is therefore as good as none.
    capacity[added] =
        arc.capacity >= total ? 2 * kMassUnits : std::llround(arc.capacity * per_unit);
  }

  // Network simplex of LEMON: primal simplex on spanning trees of the network.
  lemon::NetworkSimplex<Graph, Units, Units> simplex(graph);
  simplex.supplyMap(supply).costMap(cost).upperMap(capacity);
  if (simplex.run() != decltype(simplex)::OPTIMAL) return std::nullopt;

  std::vector<double> flow;
  flow.reserve(arcs.size());
  for (std::size_t a = 0; a < arcs.size(); ++a) {
    const auto units = static_cast<double>(simplex.flow(Graph::arcFromId(static_cast<int>(a))));
    const bool is_negligible = units < kNegligibleFlow * static_cast<double>(kMassUnits);
    flow.push_back(is_negligible ? 0.0 : units / per_unit);
  }
  return flow;
}

}  // namespace swarm::planner
