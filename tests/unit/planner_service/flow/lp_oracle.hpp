// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace swarm::test {

/// min cᵀx s.t. row_low ≤ Ax ≤ row_high, 0 ≤ x ≤ upper: the oracle of the network solvers. It knows
/// nothing of networks.
class LinearProgram {
 public:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  /// Index of the new row.
  int add_row(double low, double high);
  void add_column(double cost, std::vector<std::pair<int, double>> entries,
                  double upper = kInfinity);

  /// The optimum by Clp's dual simplex at tolerances of 1e-11; nothing when infeasible.
  std::optional<double> minimum() const;

 private:
  std::vector<double> row_low_, row_high_, cost_, upper_;
  std::vector<std::vector<std::pair<int, double>>> columns_;
};

}  // namespace swarm::test
