// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/pair_grid.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace swarm::monitor {
namespace {

/// Number of cells that a box may touch before it is handled apart. Entering a box that spans the
/// map into every cell would cost more than comparing it with all others.
constexpr double kMostCells = 256.0;

/// Closed boxes: boxes that share only an edge overlap.
bool overlap(const Box& a, const Box& b) {
  return (a.min_m.array() <= b.max_m.array()).all() && (b.min_m.array() <= a.max_m.array()).all();
}

}  // namespace

/// Enters each box into all cells it touches and sorts the entries by cell, so that the boxes of
/// one cell are neighbours in memory. O(entries · log entries).
PairGrid::PairGrid(std::span<const Item> items, double cell_m) : items_(items), cell_m_(cell_m) {
  for (std::uint32_t i = 0; i < items_.size(); ++i) {
    const Box& box = items_[i].box;
    // Upper bound of the cells per axis. The negated comparison also catches NaN of a damaged log.
    const Vec2 cells = (box.max_m - box.min_m) / cell_m_ + Vec2::Ones();
    if (!(cells.x() * cells.y() <= kMostCells)) {
      large_.push_back(i);
      continue;
    }
    for (std::int64_t x = cell_of(box.min_m.x()); x <= cell_of(box.max_m.x()); ++x) {
      for (std::int64_t y = cell_of(box.min_m.y()); y <= cell_of(box.max_m.y()); ++y) {
        entries_.push_back({x, y, i});
      }
    }
  }
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.x, a.y, a.item) < std::tie(b.x, b.y, b.item);
  });
}

std::int64_t PairGrid::cell_of(double coordinate_m) const {
  return static_cast<std::int64_t>(std::floor(coordinate_m / cell_m_));
}

/// Compares the boxes of each cell pairwise. A pair shares every cell of its overlap and is
/// reported in the cell of the overlap's lower left corner alone.
void PairGrid::for_each_pair(const std::function<void(std::uint32_t, std::uint32_t)>& visit) const {
  const auto report = [&](const Item& a, const Item& b) {
    visit(std::min(a.id, b.id), std::max(a.id, b.id));
  };
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& first = entries_[i];
    const Item& a = items_[first.item];
    for (std::size_t j = i + 1; j < entries_.size(); ++j) {
      const Entry& second = entries_[j];
      if (second.x != first.x || second.y != first.y) break;
      const Item& b = items_[second.item];
      if (!overlap(a.box, b.box)) continue;
      const Vec2 corner = a.box.min_m.cwiseMax(b.box.min_m);
      if (cell_of(corner.x()) == first.x && cell_of(corner.y()) == first.y) report(a, b);
    }
  }
  // Large boxes against all others. A pair of two large ones is reported by the one with the
  // smaller index.
  for (const std::uint32_t i : large_) {
    for (std::uint32_t j = 0; j < items_.size(); ++j) {
      const bool other_is_large = std::find(large_.begin(), large_.end(), j) != large_.end();
      if (j == i || (other_is_large && j < i) || !overlap(items_[i].box, items_[j].box)) continue;
      report(items_[i], items_[j]);
    }
  }
}

}  // namespace swarm::monitor
