// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm {

/// Twice the signed area of the polygon with these vertices [m²]; positive if they run
/// counter-clockwise, 0 for fewer than three. O(vertices).
double signed_area_twice_m2(std::span<const Vec2> vertices_m);

/// A simple polygon (no self-intersection, no holes), world frame, stored counter-clockwise.
/// A default-constructed one has no vertices and is only good for assignment.
class Polygon {
 public:
  static constexpr std::size_t kMaxVertices = 10'000;  ///< most vertices that make() accepts

  /// Makes a polygon from its corners in either orientation; repeated and collinear vertices (to 1
  /// nm) are dropped. O(n log n) where few edges overlap in x, O(n²) at worst.
  /// \return kBadInput for more than kMaxVertices, fewer than three corners, numbers that are not
  ///   finite, zero area and self-intersections (the message has the indices of both edges)
  static Result<Polygon> make(std::vector<Vec2> vertices_m);

  /// Whether both have the same vertices in the same order, to the last bit.
  bool operator==(const Polygon& other) const { return vertices_m_ == other.vertices_m_; }

  /// The corners, counter-clockwise, the first not repeated at the end [m].
  const std::vector<Vec2>& vertices_m() const { return vertices_m_; }
  /// Whether every corner turns to the left.
  bool is_convex() const { return convex_; }
  /// Whether a point lies inside, by the parity of crossings; on the border either answer may come.
  /// O(vertices). \pre not default-constructed
  bool contains(const Vec2& point_m) const;

  /// The polygon moved by a displacement [m]. O(vertices), allocates.
  Polygon shifted(const Vec2& by_m) const;

 private:
  std::vector<Vec2> vertices_m_;
  bool convex_ = false;
};

/// Splits a simple polygon into convex ones with the same union: ear clipping, then Hertel–Mehlhorn
/// merging (at most four times the optimal number of parts). Each part is the list of its corners,
/// counter-clockwise [m]. A convex polygon gives itself. Allocates.
std::vector<std::vector<Vec2>> decompose_convex(const Polygon& polygon);

}  // namespace swarm
