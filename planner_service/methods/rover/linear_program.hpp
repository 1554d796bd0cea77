// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace swarm::planner {

/// min cᵀx  s.t.  row_lower ≤ Ax ≤ row_upper,  x ≥ 0. Columns of A one after the other (CSC).
struct LinearProgram {
  std::vector<double> cost;                  ///< by column
  std::vector<double> row_lower, row_upper;  ///< ±∞ allowed
  std::vector<int> column_start{0};          ///< columns + 1 entries
  std::vector<int> row_index;
  std::vector<double> value;

  int rows() const { return static_cast<int>(row_lower.size()); }
  int columns() const { return static_cast<int>(cost.size()); }
  /// Ends the column whose entries were appended to row_index and value.
  void end_column(double column_cost) {
    cost.push_back(column_cost);
    column_start.push_back(static_cast<int>(row_index.size()));
  }
};

/// Which columns, and which rows' slacks, are basic; as many as there are rows. May come from an
/// earlier, similar program.
struct LpBasis {
  std::vector<std::uint8_t> column_basic;
  std::vector<std::uint8_t> row_basic;  ///< a row whose slack is basic does not bind
};

/// How a solve ended; kStopped: at the limit of pivots or for numerical reasons.
enum class LpStatus { kOptimal, kInfeasible, kStopped };
/// The simplex variant of a solve.
enum class LpMethod { kDualSimplex, kPrimalSimplex };

/// The optimum of a linear program with its dual prices.
struct LpSolution {
  LpStatus status = LpStatus::kStopped;
  double objective = 0.0;
  std::vector<double> x;          ///< by column
  std::vector<double> row_price;  ///< dual by row: c − Aᵀy ≥ 0 where x = 0
  int pivots = 0;
};

/// Solves with Clp, from `basis`, and leaves the optimal one there. Same input, same output.
/// Bounded by 50 pivots a row and column, then kStopped.
LpSolution solve(const LinearProgram& program, LpBasis& basis,
                 LpMethod method = LpMethod::kDualSimplex);

/// The basis in which nothing but slacks is basic.
LpBasis slack_basis(const LinearProgram& program);

}  // namespace swarm::planner
