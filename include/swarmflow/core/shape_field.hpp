// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/box.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm {

/// The shape function of a set S that robots shall fill [intermittent diffusion, eq. 6]:
///
///   F(x) = dist(x, S)²,   ∇F(x) = 2 (x − nearest point of S),   both 0 inside
///
/// S is a union of polygons and boxes, which may touch and overlap. Exact everywhere, also far from
/// S. F − ‖x‖² is concave for any S, so F(y) ≤ F(x) + ∇F·(y−x) + ‖y−x‖²: kCurvature bounds how
/// it bends upwards, at S's corners and on its medial axis too.
class ShapeField {
 public:
  /// Largest upward curvature of F, the L of Th. 6.3 for it.
  static constexpr double kCurvature = 2.0;

  /// Refuses an empty shape and boxes that are not finite or have no area. O(cells · pieces
  /// nearby).
  static Result<ShapeField> make(std::vector<Polygon> polygons, std::vector<Box> boxes_m = {});

  struct Value {
    double energy_m2 = 0.0;          ///< F
    Vec2 gradient_m = Vec2::Zero();  ///< ∇F
  };

  /// O(pieces that can be the nearest in one cell of a grid); farther from S than half its size the
  /// pieces are searched. 155 ns on average in and around the picture of a letter (276 boxes),
  /// whose middle all boxes of a bow may be nearest to. Does not allocate.
  Value at(const Vec2& point_m) const;

  /// What it was made of.
  const std::vector<Polygon>& polygons() const { return polygons_; }
  const std::vector<Box>& boxes_m() const { return boxes_m_; }
  /// Around all of S.
  const Box& extent_m() const { return extent_m_; }

 private:
  struct Nearest {
    double distance_squared_m2;
    Vec2 offset_m;  // from the nearest point of S
  };

  void build_grid();
  Nearest piece(std::uint32_t i, const Vec2& point_m) const;
  Nearest searched(const Vec2& point_m) const;

  std::vector<Polygon> polygons_;
  std::vector<Box> boxes_m_;
  Box extent_m_;
  std::vector<ConvexObstacle> parts_;  // of the polygons
  BoxIndex index_;                     // of the pieces: the boxes, then the parts
  // A grid over S and its surroundings; a cell's candidates are all pieces that are the nearest to
  // one of its points, none where it lies inside S.
  Vec2 grid_min_m_ = Vec2::Zero();
  double cells_per_m_ = 0.0;
  std::uint32_t columns_ = 0;
  std::uint32_t rows_ = 0;
  std::vector<std::uint32_t> first_;  // of candidates_, by cell, and the end
  std::vector<std::uint32_t> candidates_;
};

}  // namespace swarm
