// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/shape_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

namespace swarm {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Cells of the grid: 128 along each side of a square, 64 kB of offsets besides the candidates.
constexpr double kCellsMax = 128.0 * 128.0;
constexpr double kHair_m = 1e-9;  // slack, so that rounding does not exclude a candidate

Box grown(const Box& box, const Vec2& point_m) {
  return {box.min_m.cwiseMin(point_m), box.max_m.cwiseMax(point_m)};
}

// How deep a point is inside a box; negative outside.
double depth_m(const Box& box, const Vec2& p) {
  return std::min((p - box.min_m).minCoeff(), (box.max_m - p).minCoeff());
}

}  // namespace

// Pieces are numbered: boxes first, then convex parts of polygons, in one index.
Result<ShapeField> ShapeField::make(std::vector<Polygon> polygons, std::vector<Box> boxes_m) {
  if (polygons.empty() && boxes_m.empty()) {
    return fail(ErrorCode::kBadInput, "a shape must have a polygon or a box");
  }
  ShapeField field;
  field.extent_m_ = {Vec2::Constant(kInfinity), Vec2::Constant(-kInfinity)};
  for (std::size_t i = 0; i < boxes_m.size(); ++i) {
    const auto& [low, high] = boxes_m[i];
    if (!low.allFinite() || !high.allFinite() || !(low.array() < high.array()).all()) {
      return fail(
          ErrorCode::kBadInput,
          fmt::format("box {} is empty; must be [x0, y0, x1, y1] with x0 < x1 and y0 < y1", i));
    }
    field.extent_m_ = grown(grown(field.extent_m_, low), high);
  }
  for (const Polygon& polygon : polygons) {
    for (const Vec2& v : polygon.vertices_m()) field.extent_m_ = grown(field.extent_m_, v);
  }
  // A World decomposes polygons into convex parts, which compute signed distances.
  auto world =
      World::make(field.extent_m_, std::vector<Obstacle>(polygons.begin(), polygons.end()));
  if (!world) return tl::unexpected(world.error());
  field.parts_ = world->convex_obstacles();
  field.polygons_ = std::move(polygons);
  field.boxes_m_ = std::move(boxes_m);
  std::vector<Box> pieces = field.boxes_m_;
  for (const ConvexObstacle& part : field.parts_) pieces.push_back(part.box);
  field.index_ = BoxIndex(std::move(pieces));
  field.build_grid();
  return field;
}

// Squared distance of a point to a piece and the offset from its nearest point; 0 inside.
ShapeField::Nearest ShapeField::piece(std::uint32_t i, const Vec2& point_m) const {
  if (i < boxes_m_.size()) {
    const Box& box = boxes_m_[i];
    const Vec2 offset = point_m - point_m.cwiseMax(box.min_m).cwiseMin(box.max_m);
    return {offset.squaredNorm(), offset};
  }
  const SignedDistance sd = parts_[i - boxes_m_.size()].signed_distance(point_m);
  const double outside_m = std::max(0.0, sd.distance_m);
  return {outside_m * outside_m, outside_m * sd.gradient};
}

// Exact search without the grid: a few near pieces give a bound, the index the rest. Ends at the
// first piece that contains the point.
ShapeField::Nearest ShapeField::searched(const Vec2& point_m) const {
  Nearest best{kInfinity, Vec2::Zero()};
  const auto look = [&](std::uint32_t i) {
    const Nearest candidate = piece(i, point_m);
    if (candidate.distance_squared_m2 < best.distance_squared_m2) best = candidate;
  };
  index_.for_some_near(point_m, look);
  index_.any_within({point_m, point_m}, std::sqrt(best.distance_squared_m2), [&](std::uint32_t i) {
    const double to_box_m = index_.boxes()[i].distance_m(point_m);
    if (to_box_m * to_box_m <= best.distance_squared_m2) look(i);
    return best.distance_squared_m2 == 0.0;
  });
  return best;
}

// For each cell the pieces that can be nearest to any of its points: the distance is 1-Lipschitz,
// so a piece is no candidate if it is farther from the cell's centre than the nearest one by more
// than twice the distance from centre to corner. A cell inside one piece has no candidates, which
// stands for the value 0.
void ShapeField::build_grid() {
  // The margin covers the surroundings from which robots are likely to approach.
  const Vec2 size_m = extent_m_.max_m - extent_m_.min_m;
  const double margin_m = 0.5 * size_m.maxCoeff();
  const Vec2 grid_m = size_m + Vec2::Constant(2.0 * margin_m);
  const double cell_m = std::sqrt(grid_m.x() * grid_m.y() / kCellsMax);
  grid_min_m_ = extent_m_.min_m - Vec2::Constant(margin_m);
  cells_per_m_ = 1.0 / cell_m;
  columns_ = static_cast<std::uint32_t>(std::ceil(grid_m.x() * cells_per_m_));
  rows_ = static_cast<std::uint32_t>(std::ceil(grid_m.y() * cells_per_m_));

  const double corner_m = cell_m * std::sqrt(0.5) + kHair_m;  // from a cell's centre
  first_.reserve(std::size_t{columns_} * rows_ + 1);
  for (std::uint32_t row = 0; row < rows_; ++row) {
    for (std::uint32_t column = 0; column < columns_; ++column) {
      const std::size_t first = candidates_.size();
      first_.push_back(static_cast<std::uint32_t>(first));
      const Vec2 center = grid_min_m_ + cell_m * Vec2(column + 0.5, row + 0.5);
      const double bound_m = std::sqrt(searched(center).distance_squared_m2) + 2.0 * corner_m;
      const bool inside = index_.any_within({center, center}, bound_m, [&](std::uint32_t i) {
        if (piece(i, center).distance_squared_m2 <= bound_m * bound_m) candidates_.push_back(i);
        return i < boxes_m_.size()
                   ? depth_m(boxes_m_[i], center) > corner_m
                   : parts_[i - boxes_m_.size()].signed_distance(center).distance_m < -corner_m;
      });
      if (inside) candidates_.resize(first);
    }
  }
  first_.push_back(static_cast<std::uint32_t>(candidates_.size()));
}

// F = dist² and its gradient 2(x − nearest point) [diffusion, eq. 6]. Inside the grid only the
// candidates of the cell are visited.
ShapeField::Value ShapeField::at(const Vec2& point_m) const {
  const Vec2 cell = (point_m - grid_min_m_) * cells_per_m_;
  Nearest best{kInfinity, Vec2::Zero()};
  if (cell.x() >= 0.0 && cell.y() >= 0.0 && cell.x() < columns_ && cell.y() < rows_) {
    const std::size_t at = std::size_t{static_cast<std::uint32_t>(cell.y())} * columns_ +
                           static_cast<std::uint32_t>(cell.x());
    if (first_[at] == first_[at + 1]) return {};
    for (std::uint32_t i = first_[at]; i < first_[at + 1]; ++i) {
      const Nearest candidate = piece(candidates_[i], point_m);
      if (candidate.distance_squared_m2 < best.distance_squared_m2) best = candidate;
    }
  } else {
    best = searched(point_m);
  }
  return {best.distance_squared_m2, 2.0 * best.offset_m};
}

}  // namespace swarm
