// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "swarmflow/core/world.hpp"

namespace swarm::monitor {

/// Finds all pairs of overlapping boxes: each box is entered into every square cell that it
/// touches, and a pair is reported only in the cell that holds the lower left corner of its
/// overlap, hence once. Boxes over too many cells (of a robot that jumped) are compared with all
/// others.
class PairGrid {
 public:
  struct Item {
    std::uint32_t id;
    Box box;
  };

  /// \pre cell_m > 0; ids distinct. `items` must outlive the grid.
  PairGrid(std::span<const Item> items, double cell_m);

  /// Calls with (smaller id, larger id), in no particular order.
  void for_each_pair(const std::function<void(std::uint32_t, std::uint32_t)>& visit) const;

 private:
  struct Entry {
    std::int64_t x, y;
    std::uint32_t item;
  };

  std::int64_t cell_of(double coordinate_m) const;

  std::span<const Item> items_;
  double cell_m_;
  std::vector<Entry> entries_;        // sorted by cell
  std::vector<std::uint32_t> large_;  // items
};

}  // namespace swarm::monitor
