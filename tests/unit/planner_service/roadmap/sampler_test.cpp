// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/sampler.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/planner_service/standin_scene.hpp"

namespace swarm::planner {
namespace {

class Samplers : public ::testing::TestWithParam<SamplerKind> {};

TEST_P(Samplers, DrawTheRequestedNumberInFreeSpaceAndInRange) {
  const auto scene = test::standin_scene();
  const RiskLimit risk;
  const SamplerOptions options{.kind = GetParam()};
  Rng rng(1);

  const auto samples = sample_free(scene.world, risk, options, 500, rng);

  ASSERT_EQ(samples.size(), 500U);
  for (const Gaussian& g : samples) {
    EXPECT_TRUE(scene.world.bounds_m().contains(g.mean_m()));
    EXPECT_TRUE(in_free(g, scene.world, cvar_coefficient(risk.alpha), risk.delta_m));
    EXPECT_LE(g.max_sigma_m(), options.sigma_max_m * std::sqrt(1.0 + options.rho_max));
    if (GetParam() != SamplerKind::kFit) {
      EXPECT_GE(std::sqrt(g.covariance_m2()(0, 0)), options.sigma_min_m);
      EXPECT_GE(std::sqrt(g.covariance_m2()(1, 1)), options.sigma_min_m);
    }
  }
}

TEST_P(Samplers, RepeatThemselvesForTheSameSeed) {
  const auto scene = test::standin_scene();
  Rng a(7);
  Rng b(7);

  const auto first = sample_free(scene.world, {}, {.kind = GetParam()}, 100, a);
  const auto second = sample_free(scene.world, {}, {.kind = GetParam()}, 100, b);

  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].mean_m(), second[i].mean_m());
    EXPECT_EQ(first[i].covariance_m2(), second[i].covariance_m2());
  }
}

TEST_P(Samplers, ComeToAnEndWhereNothingIsFree) {
  const World world = World::make({{0, 0}, {10, 10}}, {Circle{{5, 5}, 20.0}}).value();
  Rng rng(1);

  EXPECT_TRUE(sample_free(world, {}, {.kind = GetParam()}, 20, rng).empty());
}

TEST_P(Samplers, NeedNoObstacles) {
  const World world = World::make({{0, 0}, {10, 10}}, {}).value();
  Rng rng(1);

  EXPECT_EQ(sample_free(world, {}, {.kind = GetParam()}, 20, rng).size(), 20U);
}

TEST_P(Samplers, PutTheBridgeShareNearObstacles) {
  const World world = World::make({{0, 0}, {200, 200}}, {Circle{{100, 100}, 20.0}}).value();
  const auto near_share = [&](double bridge_share) {
    Rng rng(3);
    int near = 0;
    const auto samples = sample_free(
        world, {}, {.kind = GetParam(), .bridge_share = bridge_share, .bridge_sigma_m = 5.0}, 400,
        rng);
    for (const Gaussian& g : samples) near += world.distance_m(g.mean_m()) < 20.0 ? 1 : 0;
    return near / 400.0;
  };

  EXPECT_NEAR(near_share(0.0), 0.1, 0.05);   // the share of the area
  EXPECT_NEAR(near_share(0.5), 0.55, 0.05);  // bridge samples are within 4 spreads
}

INSTANTIATE_TEST_SUITE_P(All, Samplers,
                         ::testing::Values(SamplerKind::kUniform, SamplerKind::kHalton,
                                           SamplerKind::kFit),
                         [](const auto& param_info) {
                           return param_info.param == SamplerKind::kUniform  ? "Uniform"
                                  : param_info.param == SamplerKind::kHalton ? "Halton"
                                                                             : "Fit";
                         });

}  // namespace
}  // namespace swarm::planner
