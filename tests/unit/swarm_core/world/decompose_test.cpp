// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "swarmflow/core/polygon.hpp"
#include "tests/unit/swarm_core/world/random_polygon.hpp"

namespace swarm {
namespace {

bool is_convex(const std::vector<Vec2>& v) {
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Vec2 first = v[(i + 1) % v.size()] - v[i];
    const Vec2 second = v[(i + 2) % v.size()] - v[(i + 1) % v.size()];
    if (first.x() * second.y() - first.y() * second.x() <= 0.0) return false;
  }
  return v.size() >= 3;
}

std::size_t reflex_corners(const std::vector<Vec2>& v) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Vec2 first = v[(i + 1) % v.size()] - v[i];
    const Vec2 second = v[(i + 2) % v.size()] - v[(i + 1) % v.size()];
    count += first.x() * second.y() - first.y() * second.x() < 0.0 ? 1 : 0;
  }
  return count;
}

// Same area and convex, and every random point lies in the polygon iff in exactly one part.
void expect_partition(const std::vector<Vec2>& vertices, Rng& rng) {
  const auto polygon = Polygon::make(vertices);
  ASSERT_TRUE(polygon.has_value()) << polygon.error().message;

  const auto parts = decompose_convex(*polygon);

  double twice_area = 0.0;
  for (const auto& part : parts) {
    EXPECT_TRUE(is_convex(part));
    twice_area += signed_area_twice_m2(part);
  }
  const double expected = signed_area_twice_m2(polygon->vertices_m());
  EXPECT_NEAR(twice_area, expected, 1e-9 * expected);  // rounding of sums over the parts
  // Hertel–Mehlhorn leaves at most two diagonals per reflex corner.
  EXPECT_LE(parts.size(), 2 * reflex_corners(polygon->vertices_m()) + 1);

  Vec2 low = vertices[0];
  Vec2 high = vertices[0];
  for (const Vec2& v : vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  for (int i = 0; i < 200; ++i) {
    const Vec2 p(uniform(rng, low.x(), high.x()), uniform(rng, low.y(), high.y()));
    int holders = 0;
    for (const auto& part : parts) holders += test::winds_around(part, p) ? 1 : 0;
    EXPECT_EQ(holders, test::winds_around(vertices, p) ? 1 : 0);
  }
}

TEST(Decomposition, LeavesConvexPolygonsAlone) {
  Rng rng(31);
  for (int round = 0; round < 20; ++round) {
    const auto polygon = Polygon::make(test::random_convex(rng, {0, 0}, 3 + rng() % 10));
    ASSERT_TRUE(polygon.has_value());

    const auto parts = decompose_convex(*polygon);

    ASSERT_EQ(parts.size(), 1U);
    EXPECT_EQ(parts[0], polygon->vertices_m());
  }
}

TEST(Decomposition, PartitionsRandomStars) {
  Rng rng(32);
  for (int round = 0; round < 200; ++round) {
    expect_partition(test::random_star(rng, {40, 30}, 4 + rng() % 30), rng);
  }
}

TEST(Decomposition, PartitionsAnLWithTheLeastNumberOfParts) {
  const auto polygon = Polygon::make({{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}});
  ASSERT_TRUE(polygon.has_value());

  EXPECT_EQ(decompose_convex(*polygon).size(), 2U);
}

TEST(Decomposition, CopesWithCollinearCornersOfACross) {
  Rng rng(33);
  expect_partition({{1, 0},
                    {2, 0},
                    {2, 1},
                    {3, 1},
                    {3, 2},
                    {2, 2},
                    {2, 3},
                    {1, 3},
                    {1, 2},
                    {0, 2},
                    {0, 1},
                    {1, 1}},
                   rng);
}

TEST(Decomposition, CopesWithStairs) {
  // All inner corners on one line: many candidate diagonals run through other corners.
  std::vector<Vec2> stairs{{0, 0}, {12, 0}};
  for (int i = 0; i < 12; ++i) {
    stairs.emplace_back(12.0 - i, i + 1.0);
    stairs.emplace_back(11.0 - i, i + 1.0);
  }
  Rng rng(34);
  expect_partition(stairs, rng);
}

TEST(Decomposition, PartitionsCombs) {
  Rng rng(35);
  for (const std::size_t teeth : {2U, 3U, 10U, 100U}) expect_partition(test::comb(teeth), rng);
}

void expect_whole_area(const std::vector<Vec2>& vertices) {
  const auto polygon = Polygon::make(vertices);
  ASSERT_TRUE(polygon.has_value()) << polygon.error().message;

  double twice_area = 0.0;
  for (const auto& part : decompose_convex(*polygon)) twice_area += signed_area_twice_m2(part);

  const double expected = signed_area_twice_m2(polygon->vertices_m());
  EXPECT_NEAR(twice_area, expected, 1e-9 * expected);
}

TEST(Decomposition, HandlesTheLargestComb) {
  expect_whole_area(test::comb(Polygon::kMaxVertices / 4));
}

// Each search for an ear from one end would pass over the whole band: minutes.
TEST(Decomposition, HandlesTheLargestZigzag) {
  expect_whole_area(test::zigzag(Polygon::kMaxVertices / 2 - 1));
}

}  // namespace
}  // namespace swarm
