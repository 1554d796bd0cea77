// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/squeeze.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "swarmflow/core/cvar.hpp"
#include "tests/unit/planner_service/standin_scene.hpp"

namespace swarm::planner {
namespace {

constexpr double kDelta_m = -0.2;

TEST(Squeeze, NarrowsTowardsAWallExactlyToTheLimit) {
  const auto wall = Polygon::make({{-500, -50}, {500, -50}, {500, 0}, {-500, 0}}).value();
  const World world = World::make({{-500, -50}, {500, 500}}, {wall}).value();
  const double k = cvar_coefficient(0.05);
  const Gaussian wide = Gaussian::from_parameters({0, 5}, 3.0, 4.0, 0.0);

  const auto squeezed = squeeze_into_free(wide, world, k, kDelta_m, 0.5);

  ASSERT_TRUE(squeezed.has_value());
  EXPECT_EQ(squeezed->mean_m(), wide.mean_m());
  EXPECT_NEAR(std::sqrt(squeezed->covariance_m2()(1, 1)), (5.0 + kDelta_m) / k, 1e-6);
  EXPECT_NEAR(squeezed->covariance_m2()(0, 0), 9.0, 1e-12);  // unchanged along the wall
  EXPECT_LE(max_cvar_m(*squeezed, world, k), kDelta_m);
}

TEST(Squeeze, LeavesAloneWhatIsFree) {
  const World world = World::make({{0, 0}, {100, 100}}, {Circle{{50, 50}, 5.0}}).value();
  const Gaussian g = Gaussian::from_parameters({10, 10}, 2.0, 3.0, 0.5);

  const auto squeezed = squeeze_into_free(g, world, 2.0627, kDelta_m, 0.5);

  ASSERT_TRUE(squeezed.has_value());
  EXPECT_EQ(squeezed->covariance_m2(), g.covariance_m2());
}

TEST(Squeeze, GivesUpWhereThereIsNoRoom) {
  const World world = World::make({{0, 0}, {100, 100}}, {Circle{{50, 50}, 5.0}}).value();
  const Gaussian inside = Gaussian::from_parameters({50, 51}, 1.0, 1.0, 0.0);
  const Gaussian touching = Gaussian::from_parameters({50, 55.1}, 1.0, 1.0, 0.0);
  const Gaussian near = Gaussian::from_parameters({50, 56.2}, 1.0, 1.0, 0.0);

  EXPECT_FALSE(squeeze_into_free(inside, world, 2.0627, kDelta_m, 0.01).has_value());
  EXPECT_FALSE(squeeze_into_free(touching, world, 2.0627, kDelta_m, 0.01).has_value());
  EXPECT_FALSE(squeeze_into_free(near, world, 2.0627, kDelta_m, 0.8).has_value());
  EXPECT_TRUE(squeeze_into_free(near, world, 2.0627, kDelta_m, 0.4).has_value());
}

TEST(Squeeze, AnswersKeepTheLimitAndTheLeastSigma) {
  const auto scene = test::standin_scene();
  const double k = cvar_coefficient(0.05);
  Rng rng(5);
  int changed = 0;
  for (int i = 0; i < 5000; ++i) {
    const Gaussian g = Gaussian::from_parameters({uniform(rng, 0, 200), uniform(rng, 0, 160)},
                                                 uniform(rng, 0.8, 8.0), uniform(rng, 0.8, 8.0),
                                                 uniform(rng, -0.6, 0.6));

    const auto squeezed = squeeze_into_free(g, scene.world, k, kDelta_m, 0.5);

    if (!squeezed) continue;
    EXPECT_TRUE(in_free(*squeezed, scene.world, k, kDelta_m));
    changed += squeezed->covariance_m2() == g.covariance_m2() ? 0 : 1;
    if (squeezed->covariance_m2() != g.covariance_m2()) {
      EXPECT_GE(squeezed->min_sigma_m(), 0.5);
    }
  }
  EXPECT_GT(changed, 500);
}

}  // namespace
}  // namespace swarm::planner
