// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/metrics/assignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

// LEMON's templates alone: its library is not linked.
#define LEMON_ONLY_TEMPLATES
#include <lemon/network_simplex.h>
#include <lemon/smart_graph.h>

#include "swarm_core/base/assert.hpp"

namespace swarm {
namespace {

/// Costs are rounded to 1e-6 and bounded by 1e9: sums of 1e15 units per pair fit 64-bit integers.
constexpr double kUnitsPerCost = 1e6;
constexpr double kMaxCost = 1e9;

/// Shortest augmenting paths after two reductions that assign most rows cheaply (Jonker and
/// Volgenant, 1987), on integer costs, so every step is exact. Invariant: with the column
/// potentials v, the reduced cost c(i, j) − v(j) of each assigned row i is least at its own column.
/// O(n³).
class Assignment {
 public:
  Assignment(const std::vector<std::int64_t>& costs, std::size_t n)
      : costs_(costs), n_(n), potential_(n, 0), row_of_(n, kNone), column_of_(n, kNone) {}

  /// The smallest total cost, in units.
  std::int64_t solve() {
    if (n_ == 1) return costs_[0];
    reduce_columns();
    for (int round = 0; round < 2; ++round) reduce_rows();
    for (const std::size_t row : free_) augment(row);
    std::int64_t total = 0;
    for (std::size_t i = 0; i < n_; ++i) total += costs_[i * n_ + column_of_[i]];
    return total;
  }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  static constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max();

  const std::int64_t* row(std::size_t i) const { return costs_.data() + i * n_; }
  void assign(std::size_t i, std::size_t j) {
    row_of_[j] = i;
    column_of_[i] = j;
  }

  /// Column reduction: assigns each column to its cheapest row if that row is still free. Then the
  /// potential of the only column of a row is lowered until another column is as good for the row.
  void reduce_columns() {
    std::vector<std::size_t> cheapest(n_, 0);
    for (std::size_t j = 0; j < n_; ++j) potential_[j] = costs_[j];
    for (std::size_t i = 1; i < n_; ++i) {
      for (std::size_t j = 0; j < n_; ++j) {
        if (row(i)[j] >= potential_[j]) continue;
        potential_[j] = row(i)[j];
        cheapest[j] = i;
      }
    }
    std::vector<std::size_t> wanted(n_, 0);
    for (std::size_t j = 0; j < n_; ++j) {
      if (++wanted[cheapest[j]] == 1) assign(cheapest[j], j);
    }
    for (std::size_t i = 0; i < n_; ++i) {
      if (wanted[i] == 0) free_.push_back(i);
      if (wanted[i] != 1) continue;
      std::int64_t least = kFar;
      for (std::size_t j = 0; j < n_; ++j) {
        if (j != column_of_[i]) least = std::min(least, row(i)[j] - potential_[j]);
      }
      potential_[column_of_[i]] -= least;
    }
  }

  /// Augmenting row reduction: each free row takes its column of least reduced cost and lowers that
  /// column's potential until its second-best column is as good; the row that owned the column
  /// becomes free. The number of tries is bounded; rows that stay free are assigned by augment().
  void reduce_rows() {
    std::vector<std::size_t> left;
    std::size_t tries = 4 * n_;
    while (!free_.empty()) {
      const std::size_t i = free_.back();
      free_.pop_back();
      if (tries == 0) {
        left.push_back(i);
        continue;
      }
      --tries;
      std::int64_t first = kFar, second = kFar;
      std::size_t at_first = 0, at_second = 0;
      for (std::size_t j = 0; j < n_; ++j) {
        const std::int64_t reduced = row(i)[j] - potential_[j];
        if (reduced >= second) continue;
        if (reduced < first) {
          second = std::exchange(first, reduced);
          at_second = std::exchange(at_first, j);
        } else {
          second = reduced;
          at_second = j;
        }
      }
      // With a strict gap the row keeps its first choice even if another row owned that column;
      // with a tie it avoids the owned column, or two rows would displace each other for ever.
      const bool outbids = first < second;
      std::size_t j = at_first;
      potential_[j] -= second - first;
      if (!outbids && row_of_[j] != kNone) j = at_second;
      const std::size_t owner = row_of_[j];
      assign(i, j);
      if (owner == kNone) continue;
      column_of_[owner] = kNone;
      (outbids ? free_ : left).push_back(owner);
    }
    free_ = std::move(left);
  }

  /// Finds the cheapest alternating path from a free row to a free column (Dijkstra on reduced
  /// costs) and reassigns the rows along it. O(n²).
  void augment(std::size_t free_row) {
    distance_.resize(n_);
    from_.assign(n_, free_row);
    open_.resize(n_);
    std::iota(open_.begin(), open_.end(), 0);
    // Distances are reduced costs c(i, j) − v(j) along the path; `from_` stores the row before a
    // column.
    std::size_t nearest = 0;  // index into open_
    for (std::size_t j = 0; j < n_; ++j) {
      distance_[j] = row(free_row)[j] - potential_[j];
      if (distance_[j] < distance_[nearest]) nearest = j;
    }
    closed_.clear();
    while (row_of_[open_[nearest]] != kNone) {
      const std::size_t j = open_[nearest];
      open_[nearest] = open_.back();
      open_.pop_back();
      closed_.push_back(j);
      const std::size_t i = row_of_[j];
      // Reaches the open columns through the row that owns column j. `offset` turns its reduced
      // costs into distances from the free row. Among equal distances a free column is preferred:
      // it ends the search.
      const std::int64_t offset = row(i)[j] - potential_[j] - distance_[j];
      std::int64_t least = kFar;
      for (std::size_t o = 0; o < open_.size(); ++o) {
        const std::size_t k = open_[o];
        const std::int64_t through = row(i)[k] - potential_[k] - offset;
        if (through < distance_[k]) {
          distance_[k] = through;
          from_[k] = i;
        }
        if (distance_[k] < least || (distance_[k] == least && row_of_[k] == kNone)) {
          least = distance_[k];
          nearest = o;
        }
      }
    }
    const std::size_t end = open_[nearest];
    const std::int64_t reached = distance_[end];
    // The update of the potentials keeps every assigned pair a cheapest one of its row.
    for (const std::size_t j : closed_) potential_[j] += distance_[j] - reached;
    // Walks back to the free row; every row on the path moves to the column after it.
    for (std::size_t j = end;;) {
      const std::size_t i = from_[j];
      const std::size_t next = column_of_[i];
      assign(i, j);
      if (i == free_row) return;
      j = next;
    }
  }

  const std::vector<std::int64_t>& costs_;
  std::size_t n_;
  std::vector<std::int64_t> potential_;
  std::vector<std::size_t> row_of_, column_of_, free_;
  std::vector<std::int64_t> distance_;
  std::vector<std::size_t> from_, open_, closed_;
};

}  // namespace

/// The transport as a minimum-cost flow on the complete bipartite graph. Integer costs make the
/// network simplex exact; arcs are added row by row, so the id of an arc is its index in `costs`.
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
  if (n == 0) return 0.0;
  std::vector<std::int64_t> units;
  units.reserve(costs.size());
  for (const double cost : costs) {
    SWARM_ASSERT(cost >= 0.0 && cost <= kMaxCost);
    units.push_back(std::llround(cost * kUnitsPerCost));
  }
  return static_cast<double>(Assignment(units, n).solve()) / kUnitsPerCost;
}

}  // namespace swarm
