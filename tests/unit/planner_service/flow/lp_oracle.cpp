// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/planner_service/flow/lp_oracle.hpp"

#include <cmath>

#include <coin/ClpSimplex.hpp>

namespace swarm::test {

int LinearProgram::add_row(double low, double high) {
  row_low_.push_back(low);
  row_high_.push_back(high);
  return static_cast<int>(row_low_.size()) - 1;
}

void LinearProgram::add_column(double cost, std::vector<std::pair<int, double>> entries,
                               double upper) {
  cost_.push_back(cost);
  upper_.push_back(upper);
  columns_.push_back(std::move(entries));
}

std::optional<double> LinearProgram::minimum() const {
  const auto bounds = [](std::vector<double> values) {
    for (double& value : values) {
      if (std::isinf(value)) value = std::copysign(COIN_DBL_MAX, value);
    }
    return values;
  };
  std::vector<CoinBigIndex> starts{0};
  std::vector<int> rows;
  std::vector<double> values;
  for (const auto& column : columns_) {
    for (const auto& [row, value] : column) {
      rows.push_back(row);
      values.push_back(value);
    }
    starts.push_back(static_cast<CoinBigIndex>(rows.size()));
  }
  const std::vector<double> lower(cost_.size(), 0.0);
  ClpSimplex clp;
  clp.setLogLevel(0);
  clp.setPrimalTolerance(1e-11);
  clp.setDualTolerance(1e-11);
  clp.loadProblem(static_cast<int>(cost_.size()), static_cast<int>(row_low_.size()), starts.data(),
                  rows.data(), values.data(), lower.data(), bounds(upper_).data(), cost_.data(),
                  bounds(row_low_).data(), bounds(row_high_).data());
  clp.dual();
  if (clp.status() != 0) return std::nullopt;
  return clp.objectiveValue();
}

}  // namespace swarm::test
