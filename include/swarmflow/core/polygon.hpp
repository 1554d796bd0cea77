// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm {

/// Twice the signed area; positive when the vertices run counter-clockwise.
double signed_area_twice_m2(std::span<const Vec2> vertices_m);

/// A simple polygon (no self-intersection, no holes), stored counter-clockwise.
class Polygon {
 public:
  static constexpr std::size_t kMaxVertices = 10'000;

  /// Either orientation is accepted; repeated and collinear vertices are dropped. Refuses fewer
  /// than three corners, non-finite numbers, zero area and self-intersections (named by their
  /// edges).
  static Result<Polygon> make(std::vector<Vec2> vertices_m);

  bool operator==(const Polygon& other) const { return vertices_m_ == other.vertices_m_; }

  const std::vector<Vec2>& vertices_m() const { return vertices_m_; }
  bool is_convex() const { return convex_; }
  bool contains(const Vec2& point_m) const;

  /// The same polygon somewhere else.
  Polygon shifted(const Vec2& by_m) const;

 private:
  std::vector<Vec2> vertices_m_;
  bool convex_ = false;
};

/// Splits a simple polygon into convex ones with the same union: ear clipping, then Hertel–Mehlhorn
/// merging (at most four times the optimal number of parts). Each part is counter-clockwise.
std::vector<std::vector<Vec2>> decompose_convex(const Polygon& polygon);

}  // namespace swarm
