// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/metrics/shortest_paths.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

World make_world(Box bounds, std::vector<Obstacle> obstacles) {
  auto world = World::make(bounds, std::move(obstacles));
  EXPECT_TRUE(world.has_value());
  return world.value_or(World{});
}

Polygon make_polygon(std::vector<Vec2> vertices) {
  auto polygon = Polygon::make(std::move(vertices));
  EXPECT_TRUE(polygon.has_value());
  return *polygon;
}

double distance(const ShortestPaths& paths, const Vec2& a, const Vec2& b) {
  return paths.distances_m(std::span(&a, 1), std::span(&b, 1))[0];
}

/// Tangent, arc, tangent around a circle that the straight line would cross.
double around_circle(const Vec2& a, const Vec2& b, const Vec2& center, double radius) {
  const Vec2 u = a - center;
  const Vec2 v = b - center;
  const double angle = std::acos(u.dot(v) / (u.norm() * v.norm()));
  const double arc = angle - std::acos(radius / u.norm()) - std::acos(radius / v.norm());
  return std::sqrt(u.squaredNorm() - radius * radius) +
         std::sqrt(v.squaredNorm() - radius * radius) + radius * arc;
}

TEST(ShortestPaths, AreStraightInTheOpen) {
  const World world = make_world({{0, 0}, {10, 10}}, {Circle{{5, 5}, 1.0}});
  const ShortestPaths paths(world, 0.2);

  EXPECT_NEAR(distance(paths, {1, 1}, {9, 1}), 8.0, 1e-12);
  EXPECT_EQ(distance(paths, {1, 1}, {1, 1}), 0.0);
}

TEST(ShortestPaths, WrapAroundACircle) {
  Rng rng(3);
  const Vec2 center(10, 10);
  for (const double radius : {0.5, 2.0, 4.0}) {
    const World world = make_world({{0, 0}, {20, 20}}, {Circle{center, radius}});
    const ShortestPaths paths(world, 0.2);
    for (int round = 0; round < 50; ++round) {
      const double turn = uniform(rng, 0.0, 2.0 * std::numbers::pi);
      const double bend = uniform(rng, -0.1, 0.1);
      const Vec2 a = center + 6.0 * Vec2(std::cos(turn), std::sin(turn));
      const Vec2 b = center - 7.0 * Vec2(std::cos(turn + bend), std::sin(turn + bend));
      const double grown = radius + 0.2;
      // The closed form holds where the circle blocks the straight line.
      if (bend * 3.2 > grown) continue;
      const double exact = around_circle(a, b, center, grown);
      const double found = distance(paths, a, b);
      EXPECT_LE(found, exact + 1e-9);
      // Inscribed chords of sagitta 1 mm: below 3 mm over half a turn at these radii.
      EXPECT_GE(found, exact - 5e-3);
    }
  }
}

TEST(ShortestPaths, TurnAtACorner) {
  // A wall from below whose upper right corner is (5, 5): the path turns at both upper corners.
  const World world =
      make_world({{0, 0}, {10, 10}}, {make_polygon({{4, -1}, {5, -1}, {5, 5}, {4, 5}})});

  EXPECT_NEAR(distance(ShortestPaths(world, 0.0), {1, 2}, {8, 1}),
              std::hypot(3, 3) + 1.0 + std::hypot(3, 4), 1e-9);

  // Grown by 0.5 m: two arcs around the corners, joined by the shifted edge.
  const double r = 0.5;
  const double u = std::hypot(3, 3);
  const double v = std::hypot(3, 4);
  // The touching radius leans from the vertical as much as the tangent from the horizontal.
  const double arc_left = std::atan2(3, 3) + std::asin(r / u);
  const double arc_right = std::atan2(4, 3) + std::asin(r / v);
  const double exact =
      std::sqrt(u * u - r * r) + r * arc_left + 1.0 + r * arc_right + std::sqrt(v * v - r * r);
  const double found = distance(ShortestPaths(world, r), {1, 2}, {8, 1});
  EXPECT_LE(found, exact + 1e-9);
  EXPECT_GE(found, exact - 5e-3);
}

TEST(ShortestPaths, DoNotLeaveTheWorld) {
  // The wall reaches beyond the upper bound: a path outside the bounds would be shorter.
  const World world =
      make_world({{0, 0}, {10, 10}}, {make_polygon({{4, 3}, {5, 3}, {5, 10.1}, {4, 10.1}})});

  EXPECT_NEAR(distance(ShortestPaths(world, 0.0), {2, 9}, {7, 9}), 2 * std::hypot(2, 6) + 1.0,
              1e-9);
}

TEST(ShortestPaths, FindNoPathThroughAClosedWall) {
  const World world =
      make_world({{0, 0}, {10, 10}}, {make_polygon({{4, 0}, {5, 0}, {5, 10}, {4, 10}})});

  EXPECT_EQ(distance(ShortestPaths(world, 0.2), {2, 5}, {7, 5}), kInfinity);
}

TEST(ShortestPaths, FindNoPathThroughAGapNarrowerThanTheRobot) {
  const World world =
      make_world({{0, 0}, {10, 10}}, {make_polygon({{4, 0}, {5, 0}, {5, 5}, {4, 5}}),
                                      make_polygon({{4, 5.39}, {5, 5.39}, {5, 10}, {4, 10}})});

  EXPECT_EQ(distance(ShortestPaths(world, 0.2), {2, 5}, {7, 5}), kInfinity);
  EXPECT_LT(distance(ShortestPaths(world, 0.19), {2, 5}, {7, 5}), 5.1);
}

TEST(ShortestPaths, LetAPointInsideAGrownObstacleOut) {
  const World world = make_world({{0, 0}, {10, 10}}, {Circle{{5, 5}, 1.0}});
  const ShortestPaths paths(world, 0.5);

  EXPECT_NEAR(distance(paths, {5, 6.2}, {5, 9}), 2.8, 1e-9);
  EXPECT_NEAR(distance(paths, {5, 9}, {5, 6.2}), 2.8, 1e-9);
}

/// Shortest path on a grid with moves to 16 neighbours: never shorter than the true one, and in
/// free space longer by at most 1/cos(½·26.57°) = 2.75 %.
class GridOracle {
 public:
  GridOracle(const World& world, double radius, double cell, int cells)
      : cell_(cell), cells_(cells), free_(static_cast<std::size_t>(cells * cells * 16)) {
    for (int i = 0; i < cells * cells; ++i) {
      for (int k = 0; k < 16; ++k) {
        const int x = i % cells + kMoves[k][0];
        const int y = i / cells + kMoves[k][1];
        if (x < 0 || y < 0 || x >= cells || y >= cells) continue;
        free_[index(i, k)] = world.segment_is_free(at(i), at(y * cells + x), radius);
      }
    }
  }

  Vec2 at(int i) const { return Vec2(i % cells_, i / cells_) * cell_; }

  std::vector<double> distances_from(int start) const {
    std::vector<double> best(static_cast<std::size_t>(cells_ * cells_), kInfinity);
    std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>>
        queue;
    best[static_cast<std::size_t>(start)] = 0.0;
    queue.emplace(0.0, start);
    while (!queue.empty()) {
      const auto [d, i] = queue.top();
      queue.pop();
      if (d > best[static_cast<std::size_t>(i)]) continue;
      for (int k = 0; k < 16; ++k) {
        if (!free_[index(i, k)]) continue;
        const int j = i + kMoves[k][0] + kMoves[k][1] * cells_;
        const double via = d + cell_ * std::hypot(kMoves[k][0], kMoves[k][1]);
        if (via >= best[static_cast<std::size_t>(j)]) continue;
        best[static_cast<std::size_t>(j)] = via;
        queue.emplace(via, j);
      }
    }
    return best;
  }

 private:
  static constexpr int kMoves[16][2] = {{1, 0},   {0, 1},   {-1, 0}, {0, -1}, {1, 1},  {-1, 1},
                                        {-1, -1}, {1, -1},  {2, 1},  {1, 2},  {-1, 2}, {-2, 1},
                                        {-2, -1}, {-1, -2}, {1, -2}, {2, -1}};
  static std::size_t index(int i, int k) { return static_cast<std::size_t>(i * 16 + k); }
  double cell_;
  int cells_;
  std::vector<bool> free_;
};

TEST(ShortestPaths, AgreeWithAGridSearchInRandomWorlds) {
  Rng rng(17);
  for (int round = 0; round < 8; ++round) {
    std::vector<Obstacle> obstacles;
    for (int i = 0; i < 9; ++i) {
      const Vec2 c(uniform(rng, 3, 17), uniform(rng, 3, 17));
      const double size = uniform(rng, 0.8, 2.5);
      if (i % 3 == 0) {
        obstacles.emplace_back(Circle{c, size});
      } else if (i % 3 == 1) {
        obstacles.emplace_back(
            make_polygon({c + Vec2(-size, -1), c + Vec2(size, 0), c + Vec2(0, size)}));
      } else {  // an L: decomposed into overlapping grown parts
        obstacles.emplace_back(
            make_polygon({c, c + Vec2(size, 0), c + Vec2(size, 0.6), c + Vec2(0.6, 0.6),
                          c + Vec2(0.6, size), c + Vec2(0, size)}));
      }
    }
    const World world = make_world({{0, 0}, {20, 20}}, std::move(obstacles));
    const double radius = 0.2;
    const double cell = 0.2;
    const GridOracle grid(world, radius, cell, 101);
    const ShortestPaths paths(world, radius);
    const int start = 5 * 101 + 5;
    ASSERT_GT(world.distance_m(grid.at(start)), radius);
    const auto by_grid = grid.distances_from(start);
    int compared = 0;
    for (int i = 0; i < 101 * 101; i += 211) {
      if (world.distance_m(grid.at(i)) < radius + 0.3) continue;
      const double on_grid = by_grid[static_cast<std::size_t>(i)];
      const double found = distance(paths, grid.at(start), grid.at(i));
      if (on_grid == kInfinity) continue;  // the grid may miss a narrow gap
      EXPECT_LE(found, on_grid + 1e-6);
      // Each turn around a corner may cost the grid up to one more cell.
      EXPECT_GE(found, on_grid / 1.0275 - 6 * cell) << grid.at(i).transpose();
      ++compared;
    }
    EXPECT_GT(compared, 10);
  }
}

TEST(ShortestPaths, StayALowerBoundInAWorldOfManyCorners) {
  std::vector<Obstacle> obstacles;
  for (int x = 0; x < 25; ++x) {
    for (int y = 0; y < 25; ++y) {
      obstacles.emplace_back(Circle{{5.0 + x, 5.0 + y}, 0.05 + 0.005 * y});
    }
  }
  const World world = make_world({{0, 0}, {35, 35}}, std::move(obstacles));
  const ShortestPaths paths(world, 0.1);

  const double found = distance(paths, {2, 16.5}, {33, 16.5});

  EXPECT_GE(found, 31.0);
  EXPECT_LE(found, 31.0 + 1e-9);  // the row between the circles is free
}

}  // namespace
}  // namespace swarm
