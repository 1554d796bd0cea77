// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "swarmflow/core/box.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/world.hpp"

namespace swarm {

/// The shape function of a set S that robots are to fill [intermittent diffusion, eq. 6]:
///
///   F(x) = dist(x, S)²,   ∇F(x) = 2 (x − nearest point of S),   both 0 inside
///
/// S is a union of polygons and boxes (the pieces), which may touch and overlap. Exact everywhere,
/// also far from S. F − ‖x‖² is concave for any S, so F(y) ≤ F(x) + ∇F·(y−x) + ‖y−x‖²: kCurvature
/// bounds the upward curvature, at S's corners and on its medial axis too.
///
/// Immutable once made, apart from assignment; const functions may run in several threads at once.
class ShapeField {
 public:
  /// Largest upward curvature of F, its share of L in [intermittent diffusion, Th. 6.3]: a gradient
  /// step h ≤ 1/L does not increase the energy.
  static constexpr double kCurvature = 2.0;

  /// Builds the field with its grid of about 128² cells over S and half its size around it, in
  /// O(cells · pieces nearby).
  /// \return kBadInput for a shape without pieces, boxes that are not finite or have no area, and
  ///   polygons without vertices or all on one line
  static Result<ShapeField> make(std::vector<Polygon> polygons, std::vector<Box> boxes_m = {});

  /// F and its gradient at one point.
  struct Value {
    double energy_m2 = 0.0;          ///< F(x) ≥ 0 [m²]
    Vec2 gradient_m = Vec2::Zero();  ///< ∇F(x), away from S [m]
  };

  /// F and ∇F at a point; on the medial axis, where ∇F is not unique, one of its valid values.
  /// O(pieces that can be the nearest within one grid cell); outside the grid a search of O(log n)
  /// and the pieces at about the least distance. 155 ns on average in and around a letter drawn by
  /// 276 boxes. Does not allocate.
  Value at(const Vec2& point_m) const;

  /// The polygons of S, as given to make().
  const std::vector<Polygon>& polygons() const { return polygons_; }
  /// The boxes of S, as given to make() [m].
  const std::vector<Box>& boxes_m() const { return boxes_m_; }
  /// Smallest box around all of S [m].
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
  // A grid over S and its surroundings; the candidates of a cell are all pieces that are the
  // nearest to one of its points; a cell inside S has none.
  Vec2 grid_min_m_ = Vec2::Zero();
  double cells_per_m_ = 0.0;
  std::uint32_t columns_ = 0;
  std::uint32_t rows_ = 0;
  std::vector<std::uint32_t>
      first_;  // per cell its first index into candidates_, then their number
  std::vector<std::uint32_t> candidates_;
};

}  // namespace swarm
