// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/shape_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "random_polygon.hpp"

namespace swarm {
namespace {

/// Two stars, one on top of a row of boxes.
ShapeField shape() {
  Rng rng(3);
  return *ShapeField::make({*Polygon::make(test::random_star(rng, {0, 0}, 12)),
                            *Polygon::make(test::random_star(rng, {25, 5}, 9))},
                           {{{20, 0}, {22, 1}}, {{22, 0}, {30, 0.5}}, {{-30, -9}, {-28, -2}}});
}

/// By all edges of all pieces.
double brute_distance_m(const ShapeField& field, const Vec2& p) {
  double best_m = std::numeric_limits<double>::infinity();
  for (const Box& box : field.boxes_m()) best_m = std::min(best_m, box.distance_m(p));
  for (const Polygon& polygon : field.polygons()) {
    if (polygon.contains(p)) return 0.0;
    const auto& v = polygon.vertices_m();
    for (std::size_t i = 0; i < v.size(); ++i) {
      const Vec2 edge = v[(i + 1) % v.size()] - v[i];
      const double s = std::clamp((p - v[i]).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
      best_m = std::min(best_m, (p - v[i] - s * edge).norm());
    }
  }
  return best_m;
}

TEST(ShapeField, IsTheSquaredDistanceNearAndFar) {
  const ShapeField field = shape();
  Rng rng(1);

  for (int i = 0; i < 20'000; ++i) {
    const Vec2 p(uniform(rng, -150, 150), uniform(rng, -100, 100));
    const double distance_m = brute_distance_m(field, p);
    EXPECT_NEAR(std::sqrt(field.at(p).energy_m2), distance_m, 1e-9) << p.transpose();
  }
}

TEST(ShapeField, GradientIsTheDerivative) {
  const ShapeField field = shape();
  Rng rng(2);
  constexpr double kStep_m = 1e-6;
  int compared = 0;

  for (int i = 0; i < 20'000; ++i) {
    const Vec2 p(uniform(rng, -45, 45), uniform(rng, -20, 20));
    const auto along = [&](const Vec2& axis) {
      return (field.at(p + kStep_m * axis).energy_m2 - field.at(p - kStep_m * axis).energy_m2) /
             (2.0 * kStep_m);
    };
    const Vec2 difference(along(Vec2::UnitX()), along(Vec2::UnitY()));
    // On the medial axis there is none; a random point is rarely that near.
    compared += (difference - field.at(p).gradient_m).norm() < 1e-4;
  }

  EXPECT_GT(compared, 19'990);
}

TEST(ShapeField, BendsUpwardsByTwoAtMost) {
  const ShapeField field = shape();
  Rng rng(4);

  for (int i = 0; i < 20'000; ++i) {
    const Vec2 p(uniform(rng, -45, 45), uniform(rng, -20, 20));
    const Vec2 step(uniform(rng, -8, 8), uniform(rng, -8, 8));
    const ShapeField::Value at = field.at(p);

    const double bound =
        at.energy_m2 + at.gradient_m.dot(step) + 0.5 * ShapeField::kCurvature * step.squaredNorm();
    EXPECT_LE(field.at(p + step).energy_m2, bound + 1e-9);
  }
}

TEST(ShapeField, RefusesWhatIsNoShape) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

  EXPECT_FALSE(ShapeField::make({}).has_value());
  EXPECT_FALSE(ShapeField::make({}, {{{0, 0}, {0, 1}}}).has_value());
  EXPECT_FALSE(ShapeField::make({}, {{{0, 0}, {kNan, 1}}}).has_value());
}

}  // namespace
}  // namespace swarm
