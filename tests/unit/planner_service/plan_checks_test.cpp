// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/plan_checks.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "swarmflow/core/cvar.hpp"

namespace swarm::planner {
namespace {

constexpr double kAlpha = 0.05;

// A wall below y = 0, far longer than the plans.
World wall() {
  return World::make({{-500, -500}, {500, 500}},
                     {Polygon::make({{-500, -500}, {500, -500}, {500, 0}, {-500, 0}}).value()})
      .value();
}
World open_field() { return World::make({{-500, -500}, {500, 500}}, {}).value(); }

Gaussian disc(double x, double y, double sigma_m) {
  return Gaussian::from_parameters({x, y}, sigma_m, sigma_m, 0.0);
}

FlowPlan leg(const Gaussian& from, const Gaussian& to) {
  return FlowPlan::make({{from, MissionTime(0), 1.0}, {to, MissionTime(10), 1.0}}, {{0, 1, 1.0}})
      .value();
}

TEST(PlannedMaxCvar, IsThatOfAHalfPlaneInClosedForm) {
  // Above a wall the CVaR of N(μ, σ²I) is −y + kσ: along the leg it is linear, largest at its end.
  const double k = cvar_coefficient(kAlpha);
  EXPECT_NEAR(planned_max_cvar_m(leg(disc(0, 9, 1.0), disc(50, 6, 1.5)), wall(), kAlpha),
              -6.0 + 1.5 * k, 1e-9);
  EXPECT_NEAR(planned_max_cvar_m(leg(disc(0, 9, 4.0), disc(50, 6, 1.5)), wall(), kAlpha),
              -9.0 + 4.0 * k, 1e-9);
}

TEST(PlannedMaxCvar, FindsAnObstacleThatOnlyTheMiddleOfALegPasses) {
  const World world = World::make({{-500, -500}, {500, 500}}, {Circle{{25, -3}, 2.0}}).value();

  const double worst_m = planned_max_cvar_m(leg(disc(0, 0, 0.5), disc(50, 0, 0.5)), world, kAlpha);

  // 1 m from the disc at the 100th of 200 parts.
  EXPECT_NEAR(worst_m, -1.0 + 0.5 * cvar_coefficient(kAlpha), 1e-9);
}

TEST(PlannedMaxCvar, IsNothingWithoutObstacles) {
  const FlowPlan plan = leg(disc(0, 0, 1.0), disc(50, 0, 1.0));
  EXPECT_EQ(planned_max_cvar_m(plan, open_field(), kAlpha),
            -std::numeric_limits<double>::infinity());
}

TEST(PlannedMaxMixtureCvar, IsThatOfItsGaussianWhereThereIsOne) {
  const double k = cvar_coefficient(kAlpha);
  // The mean is lowest at the node in the middle.
  const FlowPlan plan = FlowPlan::make({{disc(0, 9, 1.0), MissionTime(0), 1.0},
                                        {disc(20, 5, 1.0), MissionTime(8), 1.0},
                                        {disc(30, 9, 1.0), MissionTime(10), 1.0}},
                                       {{0, 1, 1.0}, {1, 2, 1.0}})
                            .value();
  EXPECT_NEAR(planned_max_mixture_cvar_m(plan, wall(), kAlpha), -5.0 + k, 1e-6);
}

TEST(PlannedMaxMixtureCvar, CountsTheTailOfAllTogether) {
  // A tenth of the swarm is near the wall. Alone its worst 5 % average −2 + k(0.05) σ; of the whole
  // swarm the worst 5 % are the worst half of that tenth.
  const FlowPlan plan = FlowPlan::make({{disc(0, 2, 1.0), MissionTime(0), 0.1},
                                        {disc(0, 400, 1.0), MissionTime(0), 0.9},
                                        {disc(50, 2, 1.0), MissionTime(10), 0.1},
                                        {disc(50, 400, 1.0), MissionTime(10), 0.9}},
                                       {{0, 2, 0.1}, {1, 3, 0.9}})
                            .value();
  const double mixture_m = planned_max_mixture_cvar_m(plan, wall(), kAlpha);
  EXPECT_NEAR(mixture_m, -2.0 + cvar_coefficient(0.5), 1e-6);
  EXPECT_LT(mixture_m, planned_max_cvar_m(plan, wall(), kAlpha));
}

TEST(PlannedObstacleShare, IsThePartOfTheGaussianBehindTheWall) {
  // A leg parallel to the wall, its mean one σ away: Φ(−1) of it is inside.
  const FlowPlan plan = leg(disc(0, 2, 2.0), disc(50, 2, 2.0));
  const double expected = 0.5 * std::erfc(1.0 / std::sqrt(2.0));
  Rng rng(1);

  const double share = planned_obstacle_share(plan, wall(), 200'000, rng);

  // The largest of 100 estimates from 2000 points each: five of their standard deviations.
  const double deviation = std::sqrt(expected * (1.0 - expected) / 2000.0);
  EXPECT_GT(share, expected);
  EXPECT_LT(share, expected + 5.0 * deviation);
}

TEST(PlannedObstacleShare, IsAllInsideAndNoneInTheOpen) {
  Rng rng(2);
  const FlowPlan inside = leg(disc(0, -200, 1.0), disc(50, -200, 1.0));
  EXPECT_EQ(planned_obstacle_share(inside, wall(), 1000, rng), 1.0);
  EXPECT_EQ(planned_obstacle_share(inside, open_field(), 1000, rng), 0.0);
  EXPECT_EQ(planned_obstacle_share(inside, wall(), 0, rng), 1.0) << "at least a point at a time";
}

TEST(PlannedObstacleShare, IsTheSameForTheSameGenerator) {
  const FlowPlan plan = leg(disc(0, 2, 2.0), disc(50, 2, 2.0));
  Rng one(7);
  Rng same(7);
  EXPECT_EQ(planned_obstacle_share(plan, wall(), 5000, one),
            planned_obstacle_share(plan, wall(), 5000, same));
}

}  // namespace
}  // namespace swarm::planner
