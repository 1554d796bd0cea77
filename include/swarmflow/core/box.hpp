// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "swarmflow/core/linalg.hpp"

namespace swarm {

/// Axis-aligned box in the world frame, its border included. By default the single point (0, 0).
/// All functions are O(1) and expect min_m ≤ max_m on both axes; this is not checked.
struct Box {
  Vec2 min_m = Vec2::Zero();  ///< corner with the smallest x and y [m]
  Vec2 max_m = Vec2::Zero();  ///< corner with the largest x and y [m]

  /// Whether a point lies inside or on the border.
  bool contains(const Vec2& p) const {
    return (p.array() >= min_m.array()).all() && (p.array() <= max_m.array()).all();
  }
  /// Distance from a point to the box, 0 inside [m].
  double distance_m(const Vec2& p) const {
    const double dx = std::max({min_m.x() - p.x(), 0.0, p.x() - max_m.x()});
    const double dy = std::max({min_m.y() - p.y(), 0.0, p.y() - max_m.y()});
    return std::sqrt(dx * dx + dy * dy);
  }
  /// Squared distance to another box, 0 where the two touch or overlap [m²].
  double gap_squared_m2(const Box& other) const {
    const Vec2 gap = (other.min_m - max_m).cwiseMax(min_m - other.max_m).cwiseMax(0.0);
    return gap.squaredNorm();
  }
};

}  // namespace swarm
