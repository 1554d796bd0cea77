// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner_service/methods/rover/horizon_network.hpp"
#include "planner_service/methods/rover/linear_program.hpp"

namespace swarm::planner {

/// A linear constraint on the weights of one step's mixture, Σ coefficient · weight ≤ 1 + s, whose
/// excess s ≥ 0 has a cost. Weights without an entry have coefficient 0.
struct WeightRow {
  std::size_t step = 1;  ///< p of (11), 1 … h
  bool by_arc = false;   ///< on π of the stage before the step, else on ω at it
  /// A coefficient that is not 0.
  struct Entry {
    std::uint32_t index = 0;  ///< vertex or arc of the graph
    double coefficient = 0.0;
  };
  std::vector<Entry> entries;
};

/// The linear programs of one FTMPC: the network's (11a–e) with weight rows, which are only ever
/// renewed or appended, so that each program starts from the basis of the one before.
///
/// A step has thousands of columns, of which a few dozen carry mass. Those that lie on nearly
/// cheapest paths are in the program at first; the rest is priced after each solve and joins when
/// its reduced cost is negative (column generation), together with the cheapest path onward from
/// its end, which gives components that no column has met yet their price. The optimum is that of
/// all columns.
class HorizonProgram {
 public:
  /// Cost of a unit of excess: more than any detour is worth.
  static constexpr double kExcessCost = 1e5;

  /// Keeps a reference to the network. `likely` are columns to begin with, besides those near
  /// cheapest paths: those of a plan made a step ago admit a feasible one now.
  HorizonProgram(const HorizonNetwork& network, std::span<const std::size_t> likely);

  /// `x` of the solution is by column of the network.
  LpSolution solve(std::span<const WeightRow> rows);

  /// The program with all columns, for other solvers: the network's, then the excess of every row.
  LinearProgram whole(std::span<const WeightRow> rows);

 private:
  // The weight rows in which a vertex or an arc of one step has a coefficient, grouped by it.
  struct Ask {
    std::uint32_t row = 0;
    double coefficient = 0.0;
  };
  using Asks = std::vector<std::vector<Ask>>;

  void ask(std::span<const WeightRow> rows);
  template <class Visit>
  void visit_column(std::size_t column, Visit visit) const;
  LinearProgram program(std::span<const std::size_t> columns) const;
  // At given row prices: the cheapest column onward from each row that no column of the program has
  // yet, and the columns with negative reduced cost.
  struct Offers {
    std::vector<std::size_t> path_on;  // column by row, columns() where it is met or a dead end
    std::vector<std::size_t> columns;
  };
  Offers offers(std::span<const double> row_price) const;
  void enter(std::size_t column, const Offers& offers);
  void meet(std::size_t row, const Offers& offers);
  void activate(std::size_t column, bool is_basic);

  const HorizonNetwork* network_;
  std::size_t rows_ = 0;                    // weight rows
  std::vector<Asks> by_vertex_, by_arc_;    // [step − 1]
  std::vector<std::size_t> active_;         // columns in the program
  std::vector<std::uint8_t> is_active_;     // by column of the network
  std::vector<std::uint8_t> column_basic_;  // by position in active_
  std::vector<std::uint8_t> excess_basic_;  // by weight row
  std::vector<std::uint8_t> row_basic_;     // equality rows, then weight rows
  std::vector<std::uint8_t> is_met_;        // by equality row: some column in the program has it
};

}  // namespace swarm::planner
