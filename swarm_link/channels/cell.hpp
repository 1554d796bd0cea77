// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include "swarmflow/core/linalg.hpp"

namespace swarm::link {

/// A square of the spatial grid that robot states are sorted into: [x, x+1) × [y, y+1) cell sizes.
struct Cell {
  std::int32_t x = 0;  ///< east
  std::int32_t y = 0;  ///< north
  auto operator<=>(const Cell&) const = default;
};

/// The cell that contains a point. Far or non-finite coordinates are clamped to ±10⁶ cells, so that
/// a forged position cannot overflow the index.
Cell cell_of(const Vec2& point_m, double cell_size_m);

/// All cells that the disc touches, sorted. O(cells of its bounding square).
std::vector<Cell> cells_touching(const Vec2& center_m, double radius_m, double cell_size_m);
/// Appends them.
void add_cells_touching(const Vec2& center_m, double radius_m, double cell_size_m,
                        std::vector<Cell>& cells);

}  // namespace swarm::link
