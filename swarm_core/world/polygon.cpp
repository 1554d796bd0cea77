// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/world/plane.hpp"

namespace swarm {
namespace {

// A corner that remembers which vertex of the caller it was.
struct Corner {
  Vec2 at_m;
  std::size_t index = 0;
};

// Whether b lies on the segment from a to c and can be removed. A corner at which the outline folds
// back (dot < 0) must stay, so that the test for self-intersection finds it.
bool is_superfluous(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 ab = b - a;
  const Vec2 bc = c - b;
  if (ab.norm() <= kTiny_m) return true;
  const Vec2 ac = c - a;
  return ab.dot(bc) > 0.0 && std::abs(cross(ab, ac)) <= kTiny_m * ac.norm();
}

// A stack: a new vertex removes the corners before it that became superfluous.
std::vector<Corner> corners_of(const std::vector<Vec2>& vertices_m) {
  std::vector<Corner> corners;
  corners.reserve(vertices_m.size());
  for (std::size_t i = 0; i < vertices_m.size(); ++i) {
    while (corners.size() >= 2 &&
           is_superfluous(corners[corners.size() - 2].at_m, corners.back().at_m, vertices_m[i])) {
      corners.pop_back();
    }
    if (corners.empty() || (corners.back().at_m - vertices_m[i]).norm() > kTiny_m) {
      corners.push_back({vertices_m[i], i});
    }
  }
  // The seam between the last vertex and the first: a repeated vertex is removed first, because it
  // would hide the others.
  while (corners.size() >= 3 && ((corners.back().at_m - corners.front().at_m).norm() <= kTiny_m ||
                                 is_superfluous(corners[corners.size() - 2].at_m,
                                                corners.back().at_m, corners.front().at_m))) {
    corners.pop_back();
  }
  while (corners.size() >= 3 &&
         is_superfluous(corners.back().at_m, corners.front().at_m, corners[1].at_m)) {
    corners.erase(corners.begin());
  }
  return corners;
}

// For p on the line through a and b.
bool on_segment(const Vec2& a, const Vec2& b, const Vec2& p) {
  return (a.cwiseMin(b).array() <= p.array()).all() && (p.array() <= a.cwiseMax(b).array()).all();
}

// Whether two segments cross or touch, by the signs of the four orientations.
bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double side_c = cross(b - a, c - a);
  const double side_d = cross(b - a, d - a);
  const double side_a = cross(d - c, a - c);
  const double side_b = cross(d - c, b - c);
  if (((side_c > 0.0) != (side_d > 0.0)) && side_c != 0.0 && side_d != 0.0 &&
      ((side_a > 0.0) != (side_b > 0.0)) && side_a != 0.0 && side_b != 0.0) {
    return true;
  }
  return (side_c == 0.0 && on_segment(a, b, c)) || (side_d == 0.0 && on_segment(a, b, d)) ||
         (side_a == 0.0 && on_segment(c, d, a)) || (side_b == 0.0 && on_segment(c, d, b));
}

// First pair of edges that meet although they should not. Edges are sorted by their left end, so
// that only pairs overlapping in x are compared.
std::optional<std::pair<std::size_t, std::size_t>> find_meeting_edges(
    const std::vector<Corner>& corners) {
  const std::size_t n = corners.size();
  const auto begin = [&](std::size_t e) -> const Vec2& { return corners[e].at_m; };
  const auto end = [&](std::size_t e) -> const Vec2& { return corners[(e + 1) % n].at_m; };
  const auto left = [&](std::size_t e) { return std::min(begin(e).x(), end(e).x()); };
  const auto right = [&](std::size_t e) { return std::max(begin(e).x(), end(e).x()); };
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return left(a) < left(b); });
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t e = order[i];
    const double right_m = right(e);
    for (std::size_t j = i + 1; j < n && left(order[j]) <= right_m; ++j) {
      const std::size_t f = order[j];
      const bool before = (f + 1) % n == e;
      const bool after = (e + 1) % n == f;
      bool meet = false;
      if (before || after) {
        // Neighbours share a corner; they meet elsewhere only by folding back onto each other.
        const Vec2 first = before ? end(f) - begin(f) : end(e) - begin(e);
        const Vec2 second = before ? end(e) - begin(e) : end(f) - begin(f);
        meet = first.dot(second) < 0.0 &&
               std::abs(cross(first, second)) <= kTiny_m * std::max(first.norm(), second.norm());
      } else {
        meet = segments_meet(begin(e), end(e), begin(f), end(f));
      }
      if (meet) return std::minmax(corners[e].index, corners[f].index);
    }
  }
  return std::nullopt;
}

}  // namespace

double signed_area_twice_m2(std::span<const Vec2> vertices_m) {
  double twice = 0.0;
  // Relative to the first vertex: far from the origin the plain formula loses its digits.
  for (std::size_t i = 2; i < vertices_m.size(); ++i) {
    twice += cross(vertices_m[i - 1] - vertices_m[0], vertices_m[i] - vertices_m[0]);
  }
  return twice;
}

// Clean-up comes before the test for self-intersection, because repeated vertices would touch.
// Orientation and convexity follow at last, from a polygon known to be simple.
Result<Polygon> Polygon::make(std::vector<Vec2> vertices_m) {
  if (vertices_m.size() > kMaxVertices) {
    return fail(ErrorCode::kBadInput, fmt::format("polygon: {} vertices, at most {} are accepted",
                                                  vertices_m.size(), kMaxVertices));
  }
  for (std::size_t i = 0; i < vertices_m.size(); ++i) {
    if (!vertices_m[i].allFinite()) {
      return fail(ErrorCode::kBadInput, fmt::format("polygon: vertex {} is not finite", i));
    }
  }
  const std::vector<Corner> corners = corners_of(vertices_m);
  if (corners.size() < 3) {
    return fail(ErrorCode::kBadInput,
                fmt::format("polygon: {} corners left without repeated and collinear vertices, "
                            "3 are needed",
                            corners.size()));
  }
  if (const auto meeting = find_meeting_edges(corners)) {
    return fail(ErrorCode::kBadInput,
                fmt::format("polygon: the edges that start at vertices {} and {} meet; a polygon "
                            "must not touch or cross itself",
                            meeting->first, meeting->second));
  }
  Polygon polygon;
  polygon.vertices_m_.reserve(corners.size());
  double perimeter_m = 0.0;
  for (const Corner& corner : corners) {
    if (!polygon.vertices_m_.empty()) {
      perimeter_m += (corner.at_m - polygon.vertices_m_.back()).norm();
    }
    polygon.vertices_m_.push_back(corner.at_m);
  }
  const double twice_area_m2 = signed_area_twice_m2(polygon.vertices_m_);
  if (std::abs(twice_area_m2) <= kTiny_m * perimeter_m) {
    return fail(ErrorCode::kBadInput, "polygon: its area is zero");
  }
  std::vector<Vec2>& v = polygon.vertices_m_;
  if (twice_area_m2 < 0.0) std::reverse(v.begin(), v.end());
  polygon.convex_ = true;
  for (std::size_t i = 0; i < v.size() && polygon.convex_; ++i) {
    const Vec2& next = v[(i + 1) % v.size()];
    polygon.convex_ = cross(next - v[i], v[(i + 2) % v.size()] - next) > 0.0;
  }
  return polygon;
}

Polygon Polygon::shifted(const Vec2& by_m) const {
  Polygon polygon = *this;
  for (Vec2& vertex : polygon.vertices_m_) vertex += by_m;
  return polygon;
}

// Ray casting to the right; the half-open comparison counts a vertex on the ray once.
bool Polygon::contains(const Vec2& point_m) const {
  bool inside = false;
  const Vec2* from = &vertices_m_.back();
  for (const Vec2& to : vertices_m_) {
    if ((from->y() > point_m.y()) != (to.y() > point_m.y())) {
      const bool left = cross(to - *from, point_m - *from) > 0.0;
      if (left == (to.y() > from->y())) inside = !inside;
    }
    from = &to;
  }
  return inside;
}

}  // namespace swarm
