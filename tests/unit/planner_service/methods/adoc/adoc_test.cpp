// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/adoc/adoc.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "planner_service/flow/build_plan.hpp"
#include "swarmflow/core/random.hpp"
#include "tests/unit/planner_service/methods/rover/rover_scene.hpp"

namespace swarm::planner {
namespace {

TEST(ObstacleGrid, IsTheShareOfSamplesInObstacles) {
  const Mission mission = test::rover_scene(2);
  const ObstacleGrid grid = ObstacleGrid::make(mission.world, 1.0).value();
  Rng rng(1);
  constexpr int kSamples = 100'000;
  for (int i = 0; i < 10; ++i) {
    const Vec2 mean_m(uniform(rng, 40.0, 160.0), uniform(rng, 10.0, 150.0));
    const Gaussian g = Gaussian::from_parameters(mean_m, uniform(rng, 3.0, 10.0),
                                                 uniform(rng, 3.0, 10.0), uniform(rng, -0.6, 0.6));
    const Mat2 root = cholesky_lower(g.covariance_m2());
    int inside = 0;
    for (int s = 0; s < kSamples; ++s) {
      const double x = standard_normal(rng);
      const Vec2 at_m = mean_m + root * Vec2(x, standard_normal(rng));
      inside += mission.world.distance_m(at_m) <= 0.0 ? 1 : 0;
    }
    // Four standard errors of the samples, and half a cell along an outline that a σ of 3 m or more
    // is spread over.
    const double share = static_cast<double>(inside) / kSamples;
    const double tolerance = 4.0 * std::sqrt(0.25 / kSamples) + 0.01;
    EXPECT_NEAR(grid.inner_product(g), share, tolerance) << i;
  }
}

TEST(ObstacleGrid, RefusesAbsurdCells) {
  const World world = World::make({{0, 0}, {200, 160}}, {}).value();
  EXPECT_FALSE(ObstacleGrid::make(world, 0.0));
  EXPECT_FALSE(ObstacleGrid::make(world, 1e-3));
}

TEST(Adoc, TakesTheStraightPathWhenNothingIsInIt) {
  const World world = World::make({{0, 0}, {200, 160}}, {}).value();
  const auto at = [](double x, double y) {
    return Mixture::make({{1.0, Gaussian::from_parameters({x, y}, 7.0710678118654755,
                                                          7.0710678118654755, 0.0)}})
        .value();
  };

  const auto routes = adoc_routes(world, at(25, 75), at(175, 75), {}).value();

  ASSERT_EQ(routes.size(), 1U);
  EXPECT_NEAR(w2_length_m(routes[0].waypoints), 150.0, 1e-9);
}

TEST(Adoc, APenaltyBuysLessOverlapWithALongerPath) {
  const Mission mission = test::rover_scene(2);
  const ObstacleGrid grid = ObstacleGrid::make(mission.world, 1.0).value();
  double last_overlap = 1e9, last_length_m = 0.0;
  for (const double penalty : {0.0, 5.0, 100.0}) {
    const auto routes =
        adoc_routes(mission.world, mission.start, mission.goal, {.penalty = penalty}).value();
    double overlap = 0.0, length_m = 0.0, mass = 0.0;
    for (const Route& route : routes) {
      mass += route.mass;
      length_m += route.mass * w2_length_m(route.waypoints);
      for (const Gaussian& g : route.waypoints) overlap += route.mass * grid.inner_product(g);
    }
    EXPECT_NEAR(mass, 1.0, 1e-9);
    EXPECT_LT(overlap, last_overlap) << penalty;
    EXPECT_GT(length_m, last_length_m) << penalty;
    last_overlap = overlap;
    last_length_m = length_m;
  }
}

TEST(Adoc, ItsRoutesAreAPlan) {
  const Mission mission = test::rover_scene(3);
  const auto routes = adoc_routes(mission.world, mission.start, mission.goal, {}).value();

  const auto plan = build_plan(routes, 4, 3, {1.25});

  ASSERT_TRUE(plan.has_value());
  EXPECT_EQ(plan->sources().size(), 4U);
  EXPECT_EQ(plan->sinks().size(), 3U);
  for (const PlanLeg& leg : plan->legs()) {
    EXPECT_TRUE(mission.world.segment_is_free(plan->nodes()[leg.from].gaussian.mean_m(),
                                              plan->nodes()[leg.to].gaussian.mean_m(), 0.99));
  }
}

TEST(Adoc, NamesWhatNoPathJoins) {
  const World world =
      World::make({{0, 0}, {200, 160}},
                  {Polygon::make({{95, 0}, {105, 0}, {105, 160}, {95, 160}}).value()})
          .value();
  const auto at = [](double x) {
    return Mixture::make({{1.0, Gaussian::from_parameters({x, 80}, 7.0, 7.0, 0.0)}}).value();
  };
  const auto routes = adoc_routes(world, at(50), at(150), {});
  ASSERT_FALSE(routes.has_value());
  EXPECT_EQ(routes.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(routes.error().message.find("0 -> 0"), std::string::npos);
}

}  // namespace
}  // namespace swarm::planner
