// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "swarm_core/gmm/wasserstein.hpp"
#include "swarm_core/world/box.hpp"

namespace swarm::planner {
namespace {

// Samples by the square cell of their mean, cells row by row: the cells around a node are three
// runs of neighbours in memory.
class MeanGrid {
 public:
  // Cells are at least `reach_m` wide, so that the 3 × 3 around a cell hold all within reach, and
  // at most about one for each node.
  MeanGrid(std::span<const Gaussian> nodes, std::size_t first, double reach_m) {
    const std::size_t count = nodes.size() - first;
    Box box{nodes[first].mean_m(), nodes[first].mean_m()};
    for (const Gaussian& node : nodes.subspan(first)) {
      box.min_m = box.min_m.cwiseMin(node.mean_m());
      box.max_m = box.max_m.cwiseMax(node.mean_m());
    }
    const Vec2 size_m = box.max_m - box.min_m;
    const auto most = std::max(1.0, std::floor(std::sqrt(static_cast<double>(count))));
    const auto cells_for = [&](double extent_m) {
      // Also right for a reach of 0 or ∞: the quotient is then ∞, NaN or 0.
      const double cells = std::floor(extent_m / reach_m);
      return cells >= 1.0 ? static_cast<std::size_t>(std::min(cells, most)) : std::size_t{1};
    };
    columns_ = cells_for(size_m.x());
    rows_ = cells_for(size_m.y());
    const auto cell_of = [](double offset_m, double extent_m, std::size_t cells) {
      if (extent_m <= 0.0) return std::size_t{0};
      const double cell = offset_m / extent_m * static_cast<double>(cells);
      return std::min(static_cast<std::size_t>(cell), cells - 1);
    };
    std::vector<std::uint32_t> cell(count);
    offset_.assign(columns_ * rows_ + 1, 0);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec2 at_m = nodes[first + i].mean_m() - box.min_m;
      cell[i] = static_cast<std::uint32_t>(cell_of(at_m.y(), size_m.y(), rows_) * columns_ +
                                           cell_of(at_m.x(), size_m.x(), columns_));
      ++offset_[cell[i] + 1];
    }
    for (std::size_t i = 1; i < offset_.size(); ++i) offset_[i] += offset_[i - 1];
    std::vector<std::uint32_t> fill(offset_.begin(), offset_.end() - 1);
    entries_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      entries_[fill[cell[i]]++] = {nodes[first + i].mean_m(),
                                   static_cast<std::uint32_t>(first + i)};
    }
  }

  // Calls `visit(i, j)` once for each two nodes whose means are within reach.
  template <class Visitor>
  void for_each_pair(double reach_squared, Visitor&& visit) const {
    for (std::size_t row = 0; row < rows_; ++row) {
      for (std::size_t column = 0; column < columns_; ++column) {
        const std::size_t cell = row * columns_ + column;
        const std::size_t left = column == 0 ? 0 : 1;
        const std::size_t right = column + 1 == columns_ ? 0 : 1;
        const bool above = row + 1 < rows_;
        for (std::uint32_t i = offset_[cell]; i < offset_[cell + 1]; ++i) {
          visit_run(i, i + 1, offset_[cell + right + 1], reach_squared, visit);
          if (!above) continue;
          visit_run(i, offset_[cell + columns_ - left], offset_[cell + columns_ + right + 1],
                    reach_squared, visit);
        }
      }
    }
  }

 private:
  struct Entry {
    Vec2 mean_m;
    std::uint32_t node = 0;
  };

  template <class Visitor>
  void visit_run(std::uint32_t i, std::uint32_t from, std::uint32_t to, double reach_squared,
                 Visitor& visit) const {
    const Entry& entry = entries_[i];
    for (std::uint32_t j = from; j < to; ++j) {
      if ((entries_[j].mean_m - entry.mean_m).squaredNorm() <= reach_squared) {
        visit(entry.node, entries_[j].node);
      }
    }
  }

  std::size_t columns_ = 1;
  std::size_t rows_ = 1;
  std::vector<std::uint32_t> offset_;
  std::vector<Entry> entries_;
};

// The relative hair lets W₂ = r count, whatever rounding does to the distance of the means.
double widened_squared(double reach_m) { return reach_m * reach_m * (1.0 + 1e-12); }

double terminal_radius_m(std::span<const Gaussian> nodes, const Gaussian& terminal,
                         std::size_t terminals, double radius_m) {
  double nearest_m2 = std::numeric_limits<double>::infinity();
  for (const Gaussian& sample : nodes.subspan(terminals)) {
    if ((sample.mean_m() - terminal.mean_m()).squaredNorm() >= nearest_m2) continue;
    nearest_m2 = std::min(nearest_m2, wasserstein2_squared(terminal, sample));
  }
  return std::isfinite(nearest_m2) ? std::max(radius_m, 2.0 * std::sqrt(nearest_m2)) : radius_m;
}

// What evenly spread nodes have, and half as much again for obstacles, where none are.
std::size_t expected_pairs(std::span<const Gaussian> nodes, double radius_m) {
  if (nodes.empty()) return 0;
  Box box{nodes.front().mean_m(), nodes.front().mean_m()};
  for (const Gaussian& node : nodes) {
    box.min_m = box.min_m.cwiseMin(node.mean_m());
    box.max_m = box.max_m.cwiseMax(node.mean_m());
  }
  const Vec2 size_m = box.max_m - box.min_m;
  const auto n = static_cast<double>(nodes.size());
  const double share = 1.5 * std::numbers::pi * radius_m * radius_m / (size_m.x() * size_m.y());
  // Nothing sensible comes out of a radius of ∞ or an area of 0: then as many as a plan has.
  const double pairs = std::isfinite(share) ? 0.5 * n * n * std::min(share, 1.0) : 16.0 * n;
  return static_cast<std::size_t>(std::min(pairs, 64.0 * n));
}

// Stable, by counting: with the other end's order before it, the whole order in linear time.
void sort_by(std::uint32_t NeighbourPair::*end, std::size_t nodes,
             std::vector<NeighbourPair>& pairs, std::vector<NeighbourPair>& sorted) {
  std::vector<std::uint32_t> fill(nodes + 1, 0);
  for (const NeighbourPair& pair : pairs) ++fill[pair.*end + 1];
  for (std::size_t i = 1; i <= nodes; ++i) fill[i] += fill[i - 1];
  sorted.resize(pairs.size());
  for (const NeighbourPair& pair : pairs) sorted[fill[pair.*end]++] = pair;
  pairs.swap(sorted);
}

}  // namespace

std::vector<NeighbourPair> terminal_neighbours(std::span<const Gaussian> nodes,
                                               std::uint32_t terminal, std::size_t terminals,
                                               double radius_m) {
  const Gaussian& from = nodes[terminal];
  const double reach_m = terminal_radius_m(nodes, from, terminals, radius_m);
  std::vector<NeighbourPair> pairs;
  for (std::uint32_t b = terminal + 1; b < nodes.size(); ++b) {
    if ((nodes[b].mean_m() - from.mean_m()).squaredNorm() > widened_squared(reach_m)) continue;
    const double distance_m = wasserstein2(from, nodes[b]);
    if (distance_m <= reach_m) pairs.push_back({terminal, b, distance_m});
  }
  return pairs;
}

std::vector<NeighbourPair> find_neighbours(std::span<const Gaussian> nodes, double radius_m,
                                           std::size_t terminals) {
  terminals = std::min(terminals, nodes.size());
  std::vector<NeighbourPair> pairs;
  pairs.reserve(expected_pairs(nodes.subspan(terminals), radius_m));
  for (std::uint32_t a = 0; a < terminals; ++a) {
    const auto found = terminal_neighbours(nodes, a, terminals, radius_m);
    pairs.insert(pairs.end(), found.begin(), found.end());
  }
  if (nodes.size() > terminals) {
    const MeanGrid grid(nodes, terminals, radius_m * (1.0 + 1e-9));
    grid.for_each_pair(widened_squared(radius_m), [&](std::uint32_t i, std::uint32_t j) {
      const auto [a, b] = std::minmax(i, j);
      const double distance_m = wasserstein2(nodes[a], nodes[b]);
      if (distance_m <= radius_m) pairs.push_back({a, b, distance_m});
    });
  }
  std::vector<NeighbourPair> sorted;
  sort_by(&NeighbourPair::b, nodes.size(), pairs, sorted);
  sort_by(&NeighbourPair::a, nodes.size(), pairs, sorted);
  return pairs;
}

}  // namespace swarm::planner
