// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/methods/apf/cotangent_repulsion.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "robot_agent/methods/shared/target_attraction.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::agent {
namespace {

constexpr CotangentOptions kOptions{.strength_m2 = 0.01, .range_m = 1.0};

Neighbour at(const Vec2& position_m) { return {RobotId(1), position_m, Vec2::Zero(), 0.1}; }

TEST(CotangentRepulsion, IsTheExactCotangentAndItsSquaredCosecant) {
  const std::vector<Neighbour> one{at({0.6, 0.0})};
  const double theta = std::numbers::pi * 0.36 / 2.0;

  const Potential g = cotangent_repulsion(Vec2::Zero(), one, kOptions);

  EXPECT_NEAR(g.energy_m2, 0.01 / std::tan(theta), 1e-15);
  // cot·csc instead of csc² would be off by cos θ = 0.84.
  EXPECT_NEAR(g.gradient_m.x(), 0.01 * std::numbers::pi * 0.6 / std::pow(std::sin(theta), 2),
              1e-14);
  EXPECT_EQ(g.gradient_m.y(), 0.0);
}

TEST(CotangentRepulsion, EndsAtItsRange) {
  const std::vector<Neighbour> near{at({0.999999, 0.0})};
  const std::vector<Neighbour> far{at({1.0, 0.0})};

  EXPECT_NEAR(cotangent_repulsion(Vec2::Zero(), near, kOptions).energy_m2, 0.0, 1e-6);
  EXPECT_EQ(cotangent_repulsion(Vec2::Zero(), far, kOptions).gradient_m, Vec2::Zero());
}

TEST(CotangentRepulsion, FadesWithoutACornerWhereAsked) {
  CotangentOptions fading = kOptions;
  fading.fade_share = 0.1;
  const auto slope = [](double d_m, const CotangentOptions& options) {
    return cotangent_repulsion(Vec2::Zero(), std::vector<Neighbour>{at({d_m, 0})}, options)
        .gradient_m.x();
  };

  EXPECT_NEAR(slope(0.9999, fading), 0.0, 1e-4);
  EXPECT_NEAR(slope(0.95, fading), 0.5 * slope(0.95, kOptions), 1e-12);
  EXPECT_EQ(slope(0.85, fading), slope(0.85, kOptions));
}

TEST(CotangentRepulsion, IsFiniteWhereRobotsCoincide) {
  const Potential g = cotangent_repulsion({1, 1}, std::vector<Neighbour>{at({1, 1})}, kOptions);

  EXPECT_TRUE(std::isfinite(g.energy_m2) && g.gradient_m.allFinite() && g.curvature > 0.0);
}

TEST(CotangentRepulsion, GradientAndCurvatureAreThoseOfDifferences) {
  Rng rng(1);
  constexpr double kStep_m = 1e-5;
  for (int run = 0; run < 500; ++run) {
    std::vector<Neighbour> others;
    for (int i = 0; i < 12; ++i) {
      const Vec2 p(uniform(rng, -1.2, 1.2), uniform(rng, -1.2, 1.2));
      // Not across the corner of g at R, and not where third differences dominate.
      if (p.norm() > 0.25 && std::abs(p.norm() - 1.0) > 1e-3) others.push_back(at(p));
    }
    const auto energy = [&](const Vec2& p) {
      return cotangent_repulsion(p, others, kOptions).energy_m2;
    };
    const Potential g = cotangent_repulsion(Vec2::Zero(), others, kOptions);
    const double angle = uniform(rng, 0.0, 6.28);
    const Vec2 axis(std::cos(angle), std::sin(angle));
    const double ahead = energy(kStep_m * axis);
    const double behind = energy(-kStep_m * axis);

    EXPECT_NEAR((ahead - behind) / (2.0 * kStep_m), g.gradient_m.dot(axis), 1e-6);
    const double bend = (ahead - 2.0 * g.energy_m2 + behind) / (kStep_m * kStep_m);
    EXPECT_LE(bend, 0.5 * g.curvature + 1e-3);  // `curvature` counts that others move as well
  }
}

TEST(TargetAttraction, GradientIsTheDerivative) {
  const Target target = target_from({0, 0}, {3, 4}, 0.1);
  constexpr double kStep_m = 1e-6;
  const Vec2 p(0.7, 1.9);

  const auto energy = [&](const Vec2& x) { return target_attraction(x, target).energy_m2; };
  const Vec2 dx(kStep_m, 0.0);
  const Vec2 dy(0.0, kStep_m);
  const Vec2 difference((energy(p + dx) - energy(p - dx)) / (2.0 * kStep_m),
                        (energy(p + dy) - energy(p - dy)) / (2.0 * kStep_m));

  EXPECT_EQ(target.width_m, 5.0);
  EXPECT_LT((difference - target_attraction(p, target).gradient_m).norm(), 1e-7);
}

}  // namespace
}  // namespace swarm::agent
