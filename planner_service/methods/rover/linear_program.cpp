// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/linear_program.hpp"

#include <algorithm>
#include <cmath>

#include <coin/ClpSimplex.hpp>
#include <coin/CoinError.hpp>

#include "swarm_core/base/assert.hpp"

namespace swarm::planner {
namespace {

// Limit of pivots per row and column: far more than our programs need, it ends a solve that cycles.
constexpr int kPivotsPerRowAndColumn = 50;

// Hands a basis to the solver. Every nonbasic variable needs the bound at which it rests: columns
// rest at 0, rows at their finite side.
void set_basis(ClpSimplex& model, const LinearProgram& program, const LpBasis& basis) {
  for (int i = 0; i < program.columns(); ++i) {
    model.setColumnStatus(i, basis.column_basic[static_cast<std::size_t>(i)] != 0
                                 ? ClpSimplex::basic
                                 : ClpSimplex::atLowerBound);
  }
  for (int i = 0; i < program.rows(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    // A row without lower bound binds at its upper one.
    const bool at_lower = std::isfinite(program.row_lower[row]);
    model.setRowStatus(i, basis.row_basic[row] != 0 ? ClpSimplex::basic
                          : at_lower                ? ClpSimplex::atLowerBound
                                                    : ClpSimplex::atUpperBound);
  }
}

// Reads the optimal basis back, from which the next program starts.
void get_basis(const ClpSimplex& model, LpBasis& basis) {
  for (std::size_t i = 0; i < basis.column_basic.size(); ++i) {
    basis.column_basic[i] = model.getColumnStatus(static_cast<int>(i)) == ClpSimplex::basic ? 1 : 0;
  }
  for (std::size_t i = 0; i < basis.row_basic.size(); ++i) {
    basis.row_basic[i] = model.getRowStatus(static_cast<int>(i)) == ClpSimplex::basic ? 1 : 0;
  }
}

}  // namespace

// The basis of all row variables: always a valid start, without knowledge of the program.
LpBasis slack_basis(const LinearProgram& program) {
  return {std::vector<std::uint8_t>(program.cost.size(), 0),
          std::vector<std::uint8_t>(program.row_lower.size(), 1)};
}

// Solves by dual or primal simplex from a given basis. Dual simplex suits a basis that was optimal
// before rows were added, primal simplex one before columns were added.
LpSolution solve(const LinearProgram& program, LpBasis& basis, LpMethod method) {
  SWARM_ASSERT(basis.column_basic.size() == program.cost.size() &&
               basis.row_basic.size() == program.row_lower.size());
  ClpSimplex model;
  model.setLogLevel(0);
  model.loadProblem(program.columns(), program.rows(), program.column_start.data(),
                    program.row_index.data(), program.value.data(), nullptr, nullptr,
                    program.cost.data(), program.row_lower.data(), program.row_upper.data());
  model.scaling(0);  // our programs are scaled as they are made
  model.setPrimalTolerance(1e-9);
  model.setDualTolerance(1e-9);
  model.setMaximumIterations(kPivotsPerRowAndColumn * (program.columns() + program.rows()));
  model.createStatus();
  set_basis(model, program, basis);
  LpSolution solution;
  try {
    if (method == LpMethod::kDualSimplex) {
      model.dual();
    } else {
      model.primal();
    }
  } catch (const CoinError&) {  // numbers it cannot handle
    return solution;
  }
  solution.pivots = model.numberIterations();
  solution.status = model.status() == 0   ? LpStatus::kOptimal
                    : model.status() == 1 ? LpStatus::kInfeasible
                                          : LpStatus::kStopped;
  if (solution.status != LpStatus::kOptimal) return solution;
  solution.objective = model.objectiveValue();
  solution.x.assign(model.primalColumnSolution(), model.primalColumnSolution() + program.columns());
  solution.row_price.assign(model.dualRowSolution(), model.dualRowSolution() + program.rows());
  get_basis(model, basis);
  return solution;
}

}  // namespace swarm::planner
