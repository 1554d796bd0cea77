// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/channels/cell.hpp"

#include <algorithm>
#include <cmath>

#include "swarm_core/base/assert.hpp"

namespace swarm::link {

namespace {

// Bound of cell indices, far below the range of 32-bit integers.
constexpr double kFarthest = 1e6;

std::int32_t index_of(double coordinate_m, double cell_size_m) {
  const double index = std::floor(coordinate_m / cell_size_m);
  if (!(index >= -kFarthest)) return static_cast<std::int32_t>(-kFarthest);  // NaN too
  return static_cast<std::int32_t>(std::min(index, kFarthest));
}

// Distance from a coordinate to the interval of a cell, 0 inside.
double gap_m(double coordinate_m, std::int32_t index, double cell_size_m) {
  const double low = index * cell_size_m;
  return std::max({low - coordinate_m, coordinate_m - (low + cell_size_m), 0.0});
}

}  // namespace

Cell cell_of(const Vec2& point_m, double cell_size_m) {
  SWARM_ASSERT(cell_size_m > 0.0);
  return {index_of(point_m.x(), cell_size_m), index_of(point_m.y(), cell_size_m)};
}

std::vector<Cell> cells_touching(const Vec2& center_m, double radius_m, double cell_size_m) {
  std::vector<Cell> cells;
  add_cells_touching(center_m, radius_m, cell_size_m, cells);
  return cells;
}

// Checks the cells of the disc's bounding square, column by column, which yields them sorted.
void add_cells_touching(const Vec2& center_m, double radius_m, double cell_size_m,
                        std::vector<Cell>& cells) {
  SWARM_ASSERT(radius_m >= 0.0);
  const Cell own = cell_of(center_m, cell_size_m);
  const Vec2 reach = Vec2::Constant(radius_m);
  const Cell low = cell_of(center_m - reach, cell_size_m);
  const Cell high = cell_of(center_m + reach, cell_size_m);
  for (auto x = low.x; x <= high.x; ++x) {
    for (auto y = low.y; y <= high.y; ++y) {
      const double dx = gap_m(center_m.x(), x, cell_size_m);
      const double dy = gap_m(center_m.y(), y, cell_size_m);
      // The cell of the centre is included even if clamping has moved it away from the point.
      if (dx * dx + dy * dy <= radius_m * radius_m || Cell{x, y} == own) cells.push_back({x, y});
    }
  }
}

}  // namespace swarm::link
