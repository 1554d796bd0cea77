// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/linear_program.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::planner {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A program with equalities and upper bounds that a random x ≥ 0 satisfies.
LinearProgram random_program(Rng& rng, int rows, int columns) {
  LinearProgram lp;
  std::vector<double> activity(static_cast<std::size_t>(rows), 0.0);
  for (int c = 0; c < columns; ++c) {
    const double x = rng() % 3 == 0 ? uniform(rng, 0.0, 1.0) : 0.0;
    for (int r = 0; r < rows; ++r) {
      if (rng() % 3 != 0) continue;
      const double value = uniform(rng, -1.0, 2.0);
      lp.row_index.push_back(r);
      lp.value.push_back(value);
      activity[static_cast<std::size_t>(r)] += value * x;
    }
    lp.end_column(uniform(rng, 0.0, 5.0));
  }
  for (int r = 0; r < rows; ++r) {
    const double here = activity[static_cast<std::size_t>(r)];
    const bool is_equality = rng() % 2 == 0;
    lp.row_lower.push_back(is_equality ? here : -kInfinity);
    lp.row_upper.push_back(is_equality ? here : here + uniform(rng, 0.0, 0.1));
  }
  return lp;
}

// Primal and dual feasibility and equal objectives prove the optimum, independently of the solver.
void expect_optimal(const LinearProgram& lp, const LpSolution& solution) {
  ASSERT_EQ(solution.status, LpStatus::kOptimal);
  std::vector<double> activity(lp.row_lower.size(), 0.0);
  double dual_objective = 0.0;
  for (int c = 0; c < lp.columns(); ++c) {
    const auto column = static_cast<std::size_t>(c);
    double reduced = lp.cost[column];
    EXPECT_GE(solution.x[column], -1e-8);
    for (int k = lp.column_start[column]; k < lp.column_start[column + 1]; ++k) {
      const auto entry = static_cast<std::size_t>(k);
      const auto row = static_cast<std::size_t>(lp.row_index[entry]);
      activity[row] += lp.value[entry] * solution.x[column];
      reduced -= lp.value[entry] * solution.row_price[row];
    }
    EXPECT_GE(reduced, -1e-7);
  }
  for (std::size_t r = 0; r < activity.size(); ++r) {
    EXPECT_LE(activity[r], lp.row_upper[r] + 1e-7);
    EXPECT_GE(activity[r], lp.row_lower[r] - 1e-7);
    if (std::isinf(lp.row_lower[r])) {
      EXPECT_LE(solution.row_price[r], 1e-8);
    }
    dual_objective += solution.row_price[r] * lp.row_upper[r];
  }
  EXPECT_NEAR(dual_objective, solution.objective, 1e-6);
}

TEST(LinearProgramSolve, IsOptimalByDuality) {
  Rng rng(1);
  for (int i = 0; i < 100; ++i) {
    const LinearProgram lp =
        random_program(rng, 2 + static_cast<int>(rng() % 20), 5 + static_cast<int>(rng() % 60));
    for (const LpMethod method : {LpMethod::kDualSimplex, LpMethod::kPrimalSimplex}) {
      LpBasis basis = slack_basis(lp);
      expect_optimal(lp, solve(lp, basis, method));
    }
  }
}

TEST(LinearProgramSolve, StartsFromTheBasisItIsGiven) {
  Rng rng(2);
  LinearProgram lp = random_program(rng, 30, 200);
  LpBasis basis = slack_basis(lp);
  const LpSolution first = solve(lp, basis);
  ASSERT_EQ(first.status, LpStatus::kOptimal);
  ASSERT_GT(first.pivots, 0);

  EXPECT_EQ(solve(lp, basis).pivots, 0);
  for (double& cost : lp.cost) cost *= uniform(rng, 0.99, 1.01);
  const LpSolution again = solve(lp, basis);

  expect_optimal(lp, again);
  EXPECT_LT(again.pivots, first.pivots);
}

TEST(LinearProgramSolve, ReportsInfeasible) {
  LinearProgram lp;  // x = −1
  lp.row_index.push_back(0);
  lp.value.push_back(1.0);
  lp.end_column(1.0);
  lp.row_lower.push_back(-1.0);
  lp.row_upper.push_back(-1.0);
  LpBasis basis = slack_basis(lp);
  EXPECT_EQ(solve(lp, basis).status, LpStatus::kInfeasible);
}

}  // namespace
}  // namespace swarm::planner
