// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/gmm/shape_patches.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "swarm_core/base/assert.hpp"

namespace swarm {
namespace {

// Moments about a reference point nearby, because sums about the origin would cancel far from it.
struct Moments {
  double weight = 0.0;
  Vec2 first = Vec2::Zero();
  Mat2 second = Mat2::Zero();

  void add(double mass, const Vec2& at) {
    weight += mass;
    first += mass * at;
    second += mass * at * at.transpose();
  }

  Patch patch(const Vec2& reference_m) const {
    const Vec2 mean = first / weight;
    return {weight, reference_m + mean, second / weight - mean * mean.transpose()};
  }
};

// ∫ over a convex polygon, as a fan of triangles: ∫xxᵀ = A/12 (Σvvᵀ + (Σv)(Σv)ᵀ).
void add_convex(std::span<const Vec2> vertices_m, const Vec2& reference_m, Moments& moments) {
  for (std::size_t i = 1; i + 1 < vertices_m.size(); ++i) {
    const Vec2 a = vertices_m[0] - reference_m;
    const Vec2 b = vertices_m[i] - reference_m;
    const Vec2 c = vertices_m[i + 1] - reference_m;
    const Vec2 ab = b - a;
    const Vec2 ac = c - a;
    const double area_m2 = 0.5 * (ab.x() * ac.y() - ab.y() * ac.x());
    const Vec2 sum = a + b + c;
    moments.weight += area_m2;
    moments.first += area_m2 / 3.0 * sum;
    moments.second +=
        area_m2 / 12.0 *
        (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
}

// The part of a convex polygon whose coordinate `axis` is in [low, high], by clipping it at two
// half-planes (Sutherland–Hodgman).
void clip(const std::vector<Vec2>& vertices_m, Eigen::Index axis, double low, double high,
          std::vector<Vec2>& scratch_m, std::vector<Vec2>& clipped_m) {
  const auto keep_side = [axis](const std::vector<Vec2>& in, double limit, double sign,
                                std::vector<Vec2>& out) {
    out.clear();
    for (std::size_t i = 0; i < in.size(); ++i) {
      const Vec2& p = in[i];
      const Vec2& q = in[(i + 1) % in.size()];
      const double beyond_p = sign * (p(axis) - limit);
      const double beyond_q = sign * (q(axis) - limit);
      if (beyond_p <= 0.0) out.push_back(p);
      if ((beyond_p < 0.0 && beyond_q > 0.0) || (beyond_p > 0.0 && beyond_q < 0.0)) {
        out.emplace_back(p + beyond_p / (beyond_p - beyond_q) * (q - p));
      }
    }
  };
  keep_side(vertices_m, high, 1.0, scratch_m);
  keep_side(scratch_m, low, -1.0, clipped_m);
}

// Square cells over the bounding box of a polygon.
struct Grid {
  Vec2 min_m;
  double cell_m;
  std::size_t columns;
  std::size_t rows;
  double edge_m(Eigen::Index axis, std::size_t i) const {
    return min_m(axis) + cell_m * static_cast<double>(i);
  }
  Vec2 center_m(std::size_t column, std::size_t row) const {
    return {edge_m(0, column) + 0.5 * cell_m, edge_m(1, row) + 0.5 * cell_m};
  }
  // Range of cells that [low, high] touches on an axis with `count` cells.
  std::pair<std::size_t, std::size_t> span_of(const std::vector<Vec2>& vertices_m,
                                              Eigen::Index axis, std::size_t count) const {
    double low = vertices_m[0](axis);
    double high = low;
    for (const Vec2& v : vertices_m) {
      low = std::min(low, v(axis));
      high = std::max(high, v(axis));
    }
    const auto index = [&](double x) {
      const double i = std::floor((x - min_m(axis)) / cell_m);
      return static_cast<std::size_t>(std::clamp(i, 0.0, static_cast<double>(count - 1)));
    };
    return {index(low), index(high) + 1};
  }
};

// The cell side gives about `cells_max` cells of equal area over the bounding box.
Grid grid_over(const std::vector<Vec2>& vertices_m, std::size_t cells_max) {
  Vec2 low = vertices_m[0];
  Vec2 high = low;
  for (const Vec2& v : vertices_m) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  const Vec2 size_m = high - low;
  // A box of one row must not need more cells than allowed either.
  const double cell_m =
      std::max(std::sqrt(size_m.x() * size_m.y() / static_cast<double>(cells_max)),
               size_m.maxCoeff() / static_cast<double>(cells_max));
  const auto count = [&](double length_m) {
    return std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(length_m / cell_m)));
  };
  return {low, cell_m, count(size_m.x()), count(size_m.y())};
}

}  // namespace

// Each convex part is cut into rows of cells and each row into cells, so a part only costs the
// cells that it touches. Moments of parts in the same cell are added: they do not overlap.
std::vector<Patch> polygon_patches(const Polygon& polygon, std::size_t cells_max) {
  SWARM_ASSERT(cells_max > 0);
  const Grid grid = grid_over(polygon.vertices_m(), cells_max);
  std::vector<Moments> cells(grid.columns * grid.rows);
  std::vector<Vec2> scratch_m;
  std::vector<Vec2> row_part_m;
  std::vector<Vec2> cell_part_m;
  for (const std::vector<Vec2>& part_m : decompose_convex(polygon)) {
    const auto [first_row, end_row] = grid.span_of(part_m, 1, grid.rows);
    for (std::size_t row = first_row; row < end_row; ++row) {
      clip(part_m, 1, grid.edge_m(1, row), grid.edge_m(1, row + 1), scratch_m, row_part_m);
      // Clipping leaves a point or a line where the part only touches the row; its area is 0.
      if (row_part_m.size() < 3) continue;
      const auto [first_column, end_column] = grid.span_of(row_part_m, 0, grid.columns);
      for (std::size_t column = first_column; column < end_column; ++column) {
        clip(row_part_m, 0, grid.edge_m(0, column), grid.edge_m(0, column + 1), scratch_m,
             cell_part_m);
        if (cell_part_m.size() < 3) continue;
        add_convex(cell_part_m, grid.center_m(column, row), cells[row * grid.columns + column]);
      }
    }
  }
  std::vector<Patch> patches;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!(cells[i].weight > 0.0)) continue;
    patches.push_back(cells[i].patch(grid.center_m(i % grid.columns, i / grid.columns)));
  }
  return patches;
}

// Blocks grow by one pixel until there are few enough of them. The moments of a block count pixels
// as points; `pixel_m2` then adds the variance of a uniform square, p²/12, for each pixel.
std::vector<Patch> image_patches(const GreyImage& image, const ImageFrame& frame,
                                 std::size_t blocks_max) {
  SWARM_ASSERT(blocks_max > 0 && image.levels.size() == image.width * image.height);
  // Number of blocks along a side, the last of which may be cut.
  const auto blocks = [](std::size_t pixels, std::size_t side) {
    return (pixels + side - 1) / side;
  };
  std::size_t side = 1;
  while (blocks(image.width, side) * blocks(image.height, side) > blocks_max) ++side;

  const Mat2 pixel_m2 = frame.pixel_m * frame.pixel_m / 12.0 * Mat2::Identity();
  std::vector<Patch> patches;
  for (std::size_t top = 0; top < image.height; top += side) {
    for (std::size_t left = 0; left < image.width; left += side) {
      Moments moments;  // in pixels from the block's corner, y up
      for (std::size_t y = top; y < std::min(top + side, image.height); ++y) {
        for (std::size_t x = left; x < std::min(left + side, image.width); ++x) {
          const unsigned level = image.levels[y * image.width + x];
          const unsigned weight = frame.dark ? 255U - level : level;
          moments.add(weight / 255.0,
                      {static_cast<double>(x - left), -static_cast<double>(y - top)});
        }
      }
      if (!(moments.weight > 0.0)) continue;
      const Patch in_pixels = moments.patch(
          Vec2(static_cast<double>(left) + 0.5, static_cast<double>(image.height - top) - 0.5));
      patches.push_back({in_pixels.weight, frame.origin_m + frame.pixel_m * in_pixels.center_m,
                         frame.pixel_m * frame.pixel_m * in_pixels.spread_m2 + pixel_m2});
    }
  }
  return patches;
}

}  // namespace swarm
