// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/polygon.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/swarm_core/world/random_polygon.hpp"

namespace swarm {
namespace {

TEST(Polygon, IsStoredCounterClockwiseWhateverComesIn) {
  const std::vector<Vec2> clockwise{{0, 0}, {0, 2}, {3, 2}, {3, 0}};

  const auto polygon = Polygon::make(clockwise);

  ASSERT_TRUE(polygon.has_value());
  EXPECT_DOUBLE_EQ(signed_area_twice_m2(clockwise), -12.0);
  EXPECT_DOUBLE_EQ(signed_area_twice_m2(polygon->vertices_m()), 12.0);
  EXPECT_TRUE(polygon->is_convex());
}

TEST(Polygon, DropsRepeatedAndCollinearVertices) {
  const auto polygon = Polygon::make(
      {{1, 0}, {2, 0}, {2, 0}, {3, 0}, {3, 3}, {1.5, 3}, {0, 3}, {0, 1}, {0, 0}, {0, 0}, {1, 0}});

  ASSERT_TRUE(polygon.has_value()) << polygon.error().message;
  EXPECT_EQ(polygon->vertices_m().size(), 4U);
}

TEST(Polygon, RefusesWhatHasNoInside) {
  const double nan = std::numeric_limits<double>::quiet_NaN();

  EXPECT_FALSE(Polygon::make({}).has_value());
  EXPECT_FALSE(Polygon::make({{0, 0}, {1, 1}}).has_value());
  EXPECT_FALSE(Polygon::make({{0, 0}, {1, 1}, {2, 2}}).has_value());
  EXPECT_FALSE(Polygon::make({{0, 0}, {1, 1}, {1, 1}, {0, 0}}).has_value());
  EXPECT_FALSE(Polygon::make({{0, 0}, {1, nan}, {2, 0}}).has_value());
  EXPECT_FALSE(Polygon::make(std::vector<Vec2>(Polygon::kMaxVertices + 1)).has_value());
}

TEST(Polygon, NamesTheEdgesThatCross) {
  const auto bow_tie = Polygon::make({{0, 0}, {4, 4}, {4, 0}, {0, 3}});

  ASSERT_FALSE(bow_tie.has_value());
  EXPECT_NE(bow_tie.error().message.find("vertices 0 and 2"), std::string::npos)
      << bow_tie.error().message;
}

TEST(Polygon, RefusesToTouchItself) {
  // A corner on another edge, a corner on another corner, a spike that folds back.
  EXPECT_FALSE(Polygon::make({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}).has_value());
  EXPECT_FALSE(Polygon::make({{0, 0}, {2, 2}, {4, 0}, {4, 4}, {2, 2}, {0, 4}}).has_value());
  EXPECT_FALSE(Polygon::make({{0, 0}, {4, 0}, {4, 4}, {8, 4}, {4, 4}, {0, 4}}).has_value());
}

TEST(Polygon, AgreesWithBruteForceOnRandomLoops) {
  Rng rng(21);
  int simple = 0;
  for (int round = 0; round < 2000; ++round) {
    std::vector<Vec2> v;
    const std::size_t n = 4 + rng() % 4;
    for (std::size_t i = 0; i < n; ++i) v.emplace_back(uniform(rng, 0, 10), uniform(rng, 0, 10));
    bool crosses = false;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = i + 2; j < n; ++j) {
        if (i == 0 && j == n - 1) continue;
        // Solves a + s·ab = c + t·cd; random corners leave the special cases out.
        const Vec2 ab = v[i + 1] - v[i];
        const Vec2 cd = v[(j + 1) % n] - v[j];
        const Vec2 ac = v[j] - v[i];
        const double det = ab.x() * cd.y() - ab.y() * cd.x();
        const double s = (ac.x() * cd.y() - ac.y() * cd.x()) / det;
        const double t = (ac.x() * ab.y() - ac.y() * ab.x()) / det;
        crosses = crosses || (s > 0 && s < 1 && t > 0 && t < 1);
      }
    }

    EXPECT_EQ(Polygon::make(v).has_value(), !crosses);
    simple += crosses ? 0 : 1;
  }
  EXPECT_GT(simple, 200);  // both answers are exercised
}

TEST(Polygon, ContainsWhatItWindsAround) {
  Rng rng(22);
  for (int round = 0; round < 50; ++round) {
    const auto vertices = test::random_star(rng, {5, -3}, 3 + rng() % 12);
    const auto polygon = Polygon::make(vertices);
    ASSERT_TRUE(polygon.has_value()) << polygon.error().message;
    for (int i = 0; i < 200; ++i) {
      const Vec2 p(uniform(rng, -6, 16), uniform(rng, -14, 8));

      EXPECT_EQ(polygon->contains(p), test::winds_around(vertices, p));
    }
  }
}

TEST(Polygon, AcceptsTheLargestOneItPromisesTo) {
  std::vector<Vec2> circle;
  for (std::size_t i = 0; i < Polygon::kMaxVertices; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / Polygon::kMaxVertices;
    circle.emplace_back(10.0 * std::cos(angle), 10.0 * std::sin(angle));
  }

  const auto polygon = Polygon::make(circle);

  ASSERT_TRUE(polygon.has_value());
  EXPECT_EQ(polygon->vertices_m().size(), Polygon::kMaxVertices);
  EXPECT_TRUE(polygon->is_convex());
}

}  // namespace
}  // namespace swarm
