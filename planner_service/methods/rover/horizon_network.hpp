// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner_service/methods/rover/risk_graph.hpp"

namespace swarm::planner {

/// Mass of the swarm at a vertex of the graph.
struct VertexMass {
  std::uint32_t vertex = 0;
  double mass = 0.0;
};

/// Length of the horizon and weights of the cost (11a).
struct HorizonCosts {
  std::size_t horizon = 3;       ///< h
  double lambda_stage = 1.0;     ///< λ_k … λ_{k+h−1}
  double lambda_terminal = 3.0;  ///< λ_{k+h}
  /// Stage p costs λ (1 + p · this): of two flows that differ only in when they wait, the one that
  /// waits later is chosen. Without it a plan could be put off at every step.
  double impatience = 1e-3;
};

/// The FTMPC's network in arc-flow form: layer 0 holds the components the swarm is in, layer p what
/// can be reached in p steps; a column for every π_{k+p−1}(i, j), then one for every π_{k+h}(m, n);
/// a row for every component of every layer (11b–d, with the weights ω eliminated) and for every
/// goal component (11e). Path flows F of the paper are not needed: CVaR depends on weights alone,
/// which are sums of arc flows. Costs (11a) are W₂² for the stages and Q(m, n), the square of the
/// length of the shortest path, for the terminal transport. (A sum of squares over the arcs instead
/// would make a staircase cost no more than its diagonal.) Lengths are in units of the collocation
/// spacing, which keeps the numbers of the program near 1.
class HorizonNetwork {
 public:
  /// A variable of the program: the flow along an arc in one stage.
  struct Column {
    std::uint32_t stage = 0;  ///< 0 … h; stage h is the terminal transport
    std::uint32_t from = 0;   ///< vertex
    std::uint32_t to = 0;     ///< vertex; of stage h the goal component
    std::uint32_t arc = 0;    ///< of the graph; of stage h unused
    double cost = 0.0;
  };

  HorizonNetwork(const RiskGraph& graph, std::span<const VertexMass> sources,
                 std::span<const double> goal_weights, const HorizonCosts& costs);

  /// Ordered by stage.
  const std::vector<Column>& columns() const { return columns_; }
  std::size_t horizon() const { return horizon_; }
  std::size_t vertices() const { return vertices_; }
  std::size_t arcs() const { return arcs_; }

  /// The equality rows and their right sides: layer by layer, then the goal components.
  const std::vector<double>& right_side() const { return right_side_; }
  std::size_t row(std::size_t layer, std::uint32_t vertex) const {
    return static_cast<std::size_t>(row_of_[layer][vertex]);
  }
  std::size_t goal_row(std::size_t goal) const { return goal_row_ + goal; }
  bool in_layer(std::size_t layer, std::uint32_t vertex) const {
    return row_of_[layer][vertex] >= 0;
  }

  /// The columns of the cheapest path from every source to every goal. Without them a program of
  /// few columns might have no solution.
  std::vector<std::size_t> cheapest_routes() const;

  /// Detour of each column: the cost of the cheapest path through it minus the cost of the cheapest
  /// path between the same source and goal, the least over all sources and goals. Never negative;
  /// +∞ where no path leads to a goal.
  std::vector<double> detours() const;

  /// Weights ω at a step, by vertex, 0 where there is no mass. `x` by column.
  std::vector<double> vertex_weights(std::size_t step, std::span<const double> x) const;
  /// Weights π of the stage that leads to a step, by arc of the graph.
  std::vector<double> arc_weights(std::size_t step, std::span<const double> x) const;

 private:
  // Cheapest paths to one goal component.
  struct Paths {
    std::vector<double> cost;         // by row below goal_row(0), +∞ where there is none
    std::vector<std::size_t> column;  // taken first
  };
  Paths paths_to(std::size_t goal) const;

  std::size_t horizon_ = 0;
  std::size_t vertices_ = 0;
  std::size_t arcs_ = 0;
  std::size_t sources_ = 0;
  std::size_t goals_ = 0;
  std::size_t goal_row_ = 0;
  std::vector<std::vector<int>> row_of_;  // [layer][vertex], −1 where not in the layer
  std::vector<Column> columns_;
  std::vector<double> right_side_;
};

}  // namespace swarm::planner
