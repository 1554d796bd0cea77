// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "swarm_core/world/plane.hpp"
#include "swarmflow/core/polygon.hpp"

namespace swarm {
namespace {

using Loop = std::vector<std::uint32_t>;  // vertex indices, counter-clockwise

// Relative to the lengths involved: a turn below this is straight.
constexpr double kStraight = 1e-12;
double turn(const Vec2& a, const Vec2& b, const Vec2& c) { return cross(b - a, c - b); }

double straight_limit(const Vec2& a, const Vec2& b, const Vec2& c) {
  return kStraight * (b - a).norm() * (c - b).norm();
}

bool turns_left(const Vec2& a, const Vec2& b, const Vec2& c) {
  return turn(a, b, c) > straight_limit(a, b, c);
}

bool does_not_turn_right(const Vec2& a, const Vec2& b, const Vec2& c) {
  return turn(a, b, c) >= -straight_limit(a, b, c);
}

bool triangle_holds(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& p) {
  return cross(b - a, p - a) >= 0.0 && cross(c - b, p - b) >= 0.0 && cross(a - c, p - c) >= 0.0;
}

// Ear clipping on a ring of the vertices that are left. An ear is a convex corner whose triangle,
// border included, holds no other vertex; every simple polygon has one, also with straight corners.
class EarClipper {
 public:
  explicit EarClipper(const std::vector<Vec2>& vertices) : v_(vertices) {
    const auto n = static_cast<std::uint32_t>(v_.size());
    next_.resize(n);
    previous_.resize(n);
    is_ear_.assign(n, Ear::kUnknown);
    for (std::uint32_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
    }
  }

  std::vector<Loop> triangles() {
    std::vector<Loop> triangles;
    triangles.reserve(v_.size() - 2);
    std::uint32_t at = 0;
    for (std::size_t left = v_.size(); left > 3; --left) {
      at = find_ear(at, left);
      triangles.push_back({previous_[at], at, next_[at]});
      next_[previous_[at]] = next_[at];
      previous_[next_[at]] = previous_[at];
      is_ear_[previous_[at]] = is_ear_[next_[at]] = Ear::kUnknown;
      // Going on at the vertex after the next keeps the triangles from fanning around one corner.
      at = next_[next_[at]];
    }
    triangles.push_back({previous_[at], at, next_[at]});
    return triangles;
  }

 private:
  enum class Ear : std::uint8_t { kUnknown, kNo, kYes };

  // All ears of a polygon together cost O(n²): cutting one changes only its two neighbours, as a
  // triangle that holds a vertex holds one that stays. A vertex on its border is an exception, so
  // the search is repeated without what is known.
  std::uint32_t find_ear(std::uint32_t start, std::size_t left) {
    if (const auto ear = next_ear(start, left)) return *ear;
    std::fill(is_ear_.begin(), is_ear_.end(), Ear::kUnknown);
    if (const auto ear = next_ear(start, left)) return *ear;
    // Only rounding leads here, in a remainder as thin as the rounding: the flattest corner is cut.
    std::uint32_t flattest = start;
    double least = std::abs(turn(v_[previous_[start]], v_[start], v_[next_[start]]));
    std::uint32_t at = start;
    for (std::size_t i = 0; i < left; ++i, at = next_[at]) {
      const double size = std::abs(turn(v_[previous_[at]], v_[at], v_[next_[at]]));
      if (size < least) {
        least = size;
        flattest = at;
      }
    }
    return flattest;
  }

  std::optional<std::uint32_t> next_ear(std::uint32_t start, std::size_t left) {
    std::uint32_t at = start;
    for (std::size_t i = 0; i < left; ++i, at = next_[at]) {
      Ear& ear = is_ear_[at];
      if (ear == Ear::kUnknown) {
        const bool is_convex = turns_left(v_[previous_[at]], v_[at], v_[next_[at]]);
        ear = is_convex && is_empty(at) ? Ear::kYes : Ear::kNo;
      }
      if (ear == Ear::kYes) return at;
    }
    return std::nullopt;
  }

  // Whether no remaining vertex lies in the triangle of a corner.
  bool is_empty(std::uint32_t ear) const {
    const Vec2& a = v_[previous_[ear]];
    const Vec2& b = v_[ear];
    const Vec2& c = v_[next_[ear]];
    for (std::uint32_t p = next_[next_[ear]]; p != previous_[ear]; p = next_[p]) {
      if (triangle_holds(a, b, c, v_[p])) return false;
    }
    return true;
  }

  const std::vector<Vec2>& v_;
  std::vector<std::uint32_t> next_, previous_;
  std::vector<Ear> is_ear_;
};

std::size_t position_of(const Loop& loop, std::uint32_t vertex) {
  return static_cast<std::size_t>(std::find(loop.begin(), loop.end(), vertex) - loop.begin());
}

// The vertex `steps` further along the loop.
std::uint32_t after(const Loop& loop, std::size_t position, std::size_t steps) {
  return loop[(position + steps) % loop.size()];
}

// Joins `left`, which holds the edge a → b, with `right`, which holds b → a, when the corners at a
// and b stay convex without the diagonal between them.
bool merge(const std::vector<Vec2>& v, Loop& left, Loop& right, std::uint32_t a, std::uint32_t b) {
  const std::size_t a_left = position_of(left, a);
  const std::size_t b_right = position_of(right, b);
  const std::uint32_t before_a = after(left, a_left, left.size() - 1);
  const std::uint32_t after_a = after(right, b_right, 2);
  const std::uint32_t before_b = after(right, b_right, right.size() - 1);
  const std::uint32_t after_b = after(left, a_left, 2);
  if (!does_not_turn_right(v[before_a], v[a], v[after_a]) ||
      !does_not_turn_right(v[before_b], v[b], v[after_b])) {
    return false;
  }
  Loop merged;
  merged.reserve(left.size() + right.size() - 2);
  for (std::size_t i = 1; i < left.size(); ++i) merged.push_back(after(left, a_left, i));
  for (std::size_t i = 1; i < right.size(); ++i) merged.push_back(after(right, b_right, i));
  left = std::move(merged);
  right.clear();
  return true;
}

// Hertel–Mehlhorn: visits every diagonal once and removes it if both its ends stay convex.
void merge_parts(const std::vector<Vec2>& v, std::vector<Loop>& parts) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> owner;  // directed edge → part
  for (std::size_t part = 0; part < parts.size(); ++part) {
    for (std::size_t i = 0; i < parts[part].size(); ++i) {
      owner[{parts[part][i], after(parts[part], i, 1)}] = part;
    }
  }
  std::vector<std::size_t> merged_into(parts.size());
  for (std::size_t part = 0; part < parts.size(); ++part) merged_into[part] = part;
  // Union-find with path halving: a part that was merged points to the part that took it.
  const auto root = [&](std::size_t part) {
    while (merged_into[part] != part) part = merged_into[part] = merged_into[merged_into[part]];
    return part;
  };
  for (const auto& [edge, part] : owner) {
    const auto [a, b] = edge;
    const auto opposite = owner.find({b, a});
    // Each diagonal has two directed edges; only one of them is used. Edges of the outline have no
    // opposite.
    if (a > b || opposite == owner.end()) continue;
    const std::size_t left = root(part);
    const std::size_t right = root(opposite->second);
    if (merge(v, parts[left], parts[right], a, b)) merged_into[right] = left;
  }
}

}  // namespace

// Straight corners, which ear clipping keeps, are dropped from the parts at the end.
std::vector<std::vector<Vec2>> decompose_convex(const Polygon& polygon) {
  const std::vector<Vec2>& v = polygon.vertices_m();
  if (polygon.is_convex()) return {v};
  std::vector<Loop> parts = EarClipper(v).triangles();
  merge_parts(v, parts);
  std::vector<std::vector<Vec2>> convex;
  for (const Loop& part : parts) {
    std::vector<Vec2> corners;
    double perimeter_m = 0.0;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Vec2& at = v[part[i]];
      const Vec2& next = v[after(part, i, 1)];
      perimeter_m += (next - at).norm();
      if (turns_left(v[after(part, i, part.size() - 1)], at, next)) corners.push_back(at);
    }
    // A part that rounding reduced to a line has no area and is dropped.
    if (corners.size() >= 3 && signed_area_twice_m2(corners) > kTiny_m * perimeter_m) {
      convex.push_back(std::move(corners));
    }
  }
  return convex;
}

}  // namespace swarm
