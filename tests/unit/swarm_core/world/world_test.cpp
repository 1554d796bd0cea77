// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/world.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/unit/swarm_core/world/random_polygon.hpp"

namespace swarm {
namespace {

World world_of(std::vector<Obstacle> obstacles) {
  return World::make({{-1000, -1000}, {1000, 1000}}, std::move(obstacles)).value();
}

Polygon polygon_of(std::vector<Vec2> vertices) {
  return Polygon::make(std::move(vertices)).value();
}

// Dense points on the boundary of an obstacle, at most `step_m` apart.
std::vector<Vec2> boundary_points(const Obstacle& obstacle, double step_m) {
  std::vector<Vec2> points;
  if (const auto* circle = std::get_if<Circle>(&obstacle)) {
    const double turn = step_m / circle->radius_m;
    for (double angle = 0.0; angle < 2.0 * std::numbers::pi; angle += turn) {
      points.emplace_back(circle->center_m +
                          circle->radius_m * Vec2(std::cos(angle), std::sin(angle)));
    }
    return points;
  }
  const auto& v = std::get<Polygon>(obstacle).vertices_m();
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Vec2 edge = v[(i + 1) % v.size()] - v[i];
    const int steps = static_cast<int>(std::ceil(edge.norm() / step_m));
    for (int s = 0; s < steps; ++s) points.emplace_back(v[i] + s * edge / steps);
  }
  return points;
}

bool holds(const Obstacle& obstacle, const Vec2& p) {
  if (const auto* circle = std::get_if<Circle>(&obstacle)) {
    return (p - circle->center_m).norm() < circle->radius_m;
  }
  return test::winds_around(std::get<Polygon>(obstacle).vertices_m(), p);
}

double brute_distance(const Obstacle& obstacle, const std::vector<Vec2>& boundary, const Vec2& p) {
  double best = std::numeric_limits<double>::infinity();
  for (const Vec2& b : boundary) best = std::min(best, (p - b).norm());
  return holds(obstacle, p) ? -best : best;
}

std::vector<Obstacle> random_obstacles(Rng& rng) {
  return {polygon_of(test::random_star(rng, {-15, 0}, 4 + rng() % 10)),
          polygon_of(test::random_convex(rng, {15, 0}, 3 + rng() % 8)),
          Circle{{0, 15}, uniform(rng, 1.0, 4.0)}};
}

TEST(World, DistanceMatchesDenseBoundarySampling) {
  Rng rng(41);
  const double step = 0.01;
  for (int round = 0; round < 10; ++round) {
    const auto obstacles = random_obstacles(rng);
    std::vector<std::vector<Vec2>> boundaries;
    for (const auto& obstacle : obstacles) boundaries.push_back(boundary_points(obstacle, step));
    const World world = world_of(obstacles);
    for (int i = 0; i < 100; ++i) {
      const Vec2 p(uniform(rng, -28, 28), uniform(rng, -12, 22));
      double expected = std::numeric_limits<double>::infinity();
      for (std::size_t o = 0; o < obstacles.size(); ++o) {
        expected = std::min(expected, brute_distance(obstacles[o], boundaries[o], p));
      }

      // The nearest boundary point is at most half a step from a sampled one.
      EXPECT_NEAR(world.distance_m(p), expected, 0.5 * step);
    }
  }
}

TEST(World, GradientIsTheDerivativeOfTheDistance) {
  Rng rng(42);
  const double h = 1e-6;
  for (int round = 0; round < 20; ++round) {
    const World world = world_of(random_obstacles(rng));
    for (int i = 0; i < 200; ++i) {
      const Vec2 p(uniform(rng, -28, 28), uniform(rng, -12, 22));
      const SignedDistance at = world.signed_distance(p);
      const Vec2 numeric(
          (world.distance_m(p + Vec2(h, 0)) - world.distance_m(p - Vec2(h, 0))) / (2 * h),
          (world.distance_m(p + Vec2(0, h)) - world.distance_m(p - Vec2(0, h))) / (2 * h));

      EXPECT_NEAR(at.gradient.norm(), 1.0, 1e-12);
      // On the medial axis the two one-sided slopes differ, and the difference quotient is shorter
      // than 1: such points (within h of the axis) are no oracle. Curvature adds h² / distance.
      if (numeric.norm() > 1.0 - 1e-6) {
        EXPECT_NEAR((at.gradient - numeric).norm(), 0.0, 1e-3);
      }
    }
  }
}

TEST(World, GradientLeadsToTheNearestBoundaryPoint) {
  Rng rng(43);
  for (int round = 0; round < 20; ++round) {
    const World world = world_of(random_obstacles(rng));
    for (int i = 0; i < 200; ++i) {
      const Vec2 p(uniform(rng, -28, 28), uniform(rng, -12, 22));
      const SignedDistance at = world.signed_distance(p);

      EXPECT_NEAR(world.distance_m(p - at.distance_m * at.gradient), 0.0, 1e-9);
    }
  }
}

TEST(World, GradientAtCornersAndOnEdgesIsAUnitVectorOutwards) {
  const World world = world_of({polygon_of({{0, 0}, {4, 0}, {4, 2}, {0, 2}})});

  const SignedDistance corner = world.signed_distance({4, 2});
  const SignedDistance edge = world.signed_distance({2, 2});
  const SignedDistance beyond = world.signed_distance({7, 6});

  EXPECT_NEAR(corner.distance_m, 0.0, 1e-12);
  EXPECT_NEAR(corner.gradient.norm(), 1.0, 1e-12);
  EXPECT_GE(corner.gradient.minCoeff(), 0.0);
  EXPECT_NEAR((edge.gradient - Vec2(0, 1)).norm(), 0.0, 1e-12);
  EXPECT_DOUBLE_EQ(beyond.distance_m, 5.0);
  EXPECT_NEAR((beyond.gradient - Vec2(0.6, 0.8)).norm(), 0.0, 1e-12);
}

TEST(World, InsideAReflexCornerTheGradientPointsAtTheCorner) {
  const World world = world_of({polygon_of({{0, 0}, {8, 0}, {8, 4}, {4, 4}, {4, 8}, {0, 8}})});

  const SignedDistance at = world.signed_distance({3, 3});

  EXPECT_NEAR(at.distance_m, -std::sqrt(2.0), 1e-12);
  EXPECT_NEAR((at.gradient - Vec2(1, 1).normalized()).norm(), 0.0, 1e-12);
}

TEST(World, CentreOfACircleHasAUnitGradient) {
  const World world = world_of({Circle{{1, 2}, 3.0}});

  const SignedDistance at = world.signed_distance({1, 2});

  EXPECT_DOUBLE_EQ(at.distance_m, -3.0);
  EXPECT_DOUBLE_EQ(at.gradient.norm(), 1.0);
}

TEST(World, ConvexPartsSeeTheSameSurfaceFromOutside) {
  Rng rng(44);
  for (int round = 0; round < 20; ++round) {
    const World world = world_of(random_obstacles(rng));
    for (int i = 0; i < 100; ++i) {
      const Vec2 p(uniform(rng, -28, 28), uniform(rng, -12, 22));
      double nearest = std::numeric_limits<double>::infinity();
      for (const ConvexObstacle& part : world.convex_obstacles()) {
        nearest = std::min(nearest, part.signed_distance(p).distance_m);
      }
      if (world.distance_m(p) > 0.0) {
        EXPECT_NEAR(nearest, world.distance_m(p), 1e-9);
      }
      for (const double clearance_m : {0.0, 0.5, 3.0}) {
        EXPECT_EQ(world.is_clear(p, clearance_m), nearest > clearance_m);
        EXPECT_EQ(world.distance_up_to_m(p, clearance_m),
                  std::min(clearance_m, world.distance_m(p)));
      }
    }
  }
}

TEST(World, EdgesOfConvexPartsAreUnitVectorsAlongAndOutOfThem) {
  Rng rng(46);
  const World world = world_of(random_obstacles(rng));
  int edges = 0;
  for (const ConvexObstacle& part : world.convex_obstacles()) {
    for (const ConvexEdge& edge : part.edges) {
      ++edges;
      EXPECT_GT(edge.length_m, 0.0);
      EXPECT_NEAR(edge.direction.norm(), 1.0, 1e-12);
      EXPECT_NEAR(edge.normal.norm(), 1.0, 1e-12);
      EXPECT_NEAR(edge.direction.dot(edge.normal), 0.0, 1e-12);
      const Vec2 middle_m = edge.from_m + 0.5 * edge.length_m * edge.direction;
      EXPECT_NEAR(part.signed_distance(middle_m + 0.01 * edge.normal).distance_m, 0.01, 1e-9);
    }
  }
  EXPECT_GT(edges, 3);
}

TEST(World, SegmentIsFreeIffItsNearestSampleIs) {
  Rng rng(45);
  int free_segments = 0;
  for (int round = 0; round < 20; ++round) {
    const World world = world_of(random_obstacles(rng));
    for (int i = 0; i < 200; ++i) {
      const Vec2 from(uniform(rng, -28, 28), uniform(rng, -12, 22));
      const Vec2 to(uniform(rng, -28, 28), uniform(rng, -12, 22));
      const double clearance = uniform(rng, 0.0, 2.0);
      const int steps = 2000;
      double nearest = std::numeric_limits<double>::infinity();
      for (int s = 0; s <= steps; ++s) {
        nearest = std::min(nearest, world.distance_m(from + (to - from) * s / steps));
      }
      // The distance is 1-Lipschitz: between samples it drops by at most half a step.
      const double half_step = 0.5 * (to - from).norm() / steps;

      const bool is_free = world.segment_is_free(from, to, clearance);

      if (nearest < clearance) {
        EXPECT_FALSE(is_free);
      }
      if (nearest > clearance + half_step) {
        EXPECT_TRUE(is_free);
      }
      free_segments += is_free ? 1 : 0;
    }
  }
  EXPECT_GT(free_segments, 500);
  EXPECT_LT(free_segments, 3500);
}

TEST(World, SegmentAlongAWallAtExactlyTheClearanceIsFree) {
  const World world = world_of({polygon_of({{0, 0}, {900, 0}, {900, -20}, {0, -20}})});

  EXPECT_TRUE(world.segment_is_free({0, 0.25}, {900, 0.25}, 0.25));
  EXPECT_TRUE(world.segment_is_free({-50, 0.25}, {950, 0.25}, 0.25));
  EXPECT_FALSE(world.segment_is_free({0, 0.249}, {900, 0.249}, 0.25));
  EXPECT_FALSE(world.segment_is_free({0, 0.25}, {900, 0.2}, 0.25));
}

TEST(World, SegmentInsideAnObstacleIsNotFree) {
  const World world =
      world_of({polygon_of({{0, 0}, {90, 0}, {90, 90}, {0, 90}}), Circle{{200, 0}, 50}});

  EXPECT_FALSE(world.segment_is_free({40, 40}, {50, 50}, 0.0));
  EXPECT_FALSE(world.segment_is_free({40, 40}, {40, 40}, 0.0));
  EXPECT_FALSE(world.segment_is_free({190, 0}, {210, 0}, 0.0));
  EXPECT_FALSE(world.segment_is_free({0, 0}, {90, 90}, 0.0));  // the diagonal, corner to corner
  EXPECT_TRUE(world.segment_is_free({-1, -1}, {-1, -1}, 1.0));
}

TEST(World, WithoutObstaclesEverythingIsFree) {
  const World world;

  EXPECT_EQ(world.distance_m({3, 4}), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(world.segment_is_free({0, 0}, {1e6, 1e6}, 100.0));
  EXPECT_EQ(world.bounds_m().max_m, Vec2(0, 0));
}

TEST(World, RefusesBadRectanglesAndCircles) {
  const double nan = std::numeric_limits<double>::quiet_NaN();

  EXPECT_FALSE(World::make({{0, 0}, {0, 1}}, {}).has_value());
  EXPECT_FALSE(World::make({{0, 0}, {nan, 1}}, {}).has_value());
  EXPECT_FALSE(World::make({{0, 0}, {9, 9}}, {Circle{{1, 1}, 0.0}}).has_value());
  EXPECT_FALSE(World::make({{0, 0}, {9, 9}}, {Circle{{1, nan}, 1.0}}).has_value());
  EXPECT_FALSE(World::make({{0, 0}, {9, 9}}, {Obstacle{}}).has_value());
}

}  // namespace
}  // namespace swarm
