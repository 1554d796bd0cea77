// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/shared/route_plan.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "planner_service/flow/build_plan.hpp"

namespace swarm::planner {
namespace {

Gaussian disc(double x, double y, double sigma_m = 1.0) {
  return Gaussian::from_parameters({x, y}, sigma_m, sigma_m, 0.0);
}

// 3 m + 4 m for a quarter of the swarm, 10 m for the rest; the first one grows from
// 1 m to 3 m, in W₂ √2 · 2 m.
std::vector<Route> two_routes() {
  return {
      {.from = 0, .to = 0, .mass = 0.25, .waypoints = {disc(0, 0), disc(3, 0), disc(3, 4, 3.0)}},
      {.from = 1, .to = 1, .mass = 0.75, .waypoints = {disc(0, 50), disc(10, 50)}}};
}

TEST(MeasureRoutes, WeighsLengthsByTheShareOfTheSwarm) {
  const std::vector<Route> routes = two_routes();
  std::vector<Route> raw = routes;
  raw[1].waypoints = {disc(0, 50), disc(5, 62), disc(10, 50)};  // 13 m twice
  PlanStats stats;

  measure_routes(stats, raw, routes);

  EXPECT_NEAR(stats.raw_mean_path_m, 0.25 * 7.0 + 0.75 * 26.0, 1e-12);
  EXPECT_NEAR(stats.planned_mean_path_m, 0.25 * 7.0 + 0.75 * 10.0, 1e-12);
  EXPECT_NEAR(stats.cost_m, 0.25 * (3.0 + std::sqrt(16.0 + 8.0)) + 0.75 * 10.0, 1e-12);
}

TEST(MeasureFlow, AgreesWithTheRoutesThatTheFlowIsMadeOf) {
  const std::vector<Route> routes = two_routes();
  PlanStats of_routes;
  measure_routes(of_routes, routes, routes);
  const auto flow = build_plan(routes, 2, 2, {});
  ASSERT_TRUE(flow.has_value()) << flow.error().message;
  PlanStats of_flow;

  measure_flow(of_flow, *flow);

  EXPECT_NEAR(of_flow.planned_mean_path_m, of_routes.planned_mean_path_m, 1e-12);
  EXPECT_NEAR(of_flow.cost_m, of_routes.cost_m, 1e-12);
  EXPECT_EQ(of_flow.raw_mean_path_m, of_flow.planned_mean_path_m);
  EXPECT_NEAR(mean_path_m(*flow), of_routes.planned_mean_path_m, 1e-12);
}

TEST(LegSpeed, IsNotLimitedByBodiesThatAreNotKnown) {
  const LegSpeed unknown = leg_speed(1.5, SwarmLimits{});
  EXPECT_EQ(unknown.means_mps, 1.5);
  EXPECT_TRUE(std::isinf(unknown.robots_mps));

  SwarmLimits limits;
  limits.robot_speed_mps = 2.0;
  EXPECT_EQ(leg_speed(1.5, limits).robots_mps, 2.0);
  EXPECT_EQ(leg_speed(1.5, limits).means_mps, 1.5);
}

TEST(Terminals, AreTheStartComponentsThenTheGoalComponents) {
  const World world = World::make({{0, 0}, {60, 60}}, {}).value();
  const Mixture start = Mixture::make({{0.4, disc(1, 1)}, {0.6, disc(2, 1)}}).value();
  const Mixture goal =
      Mixture::make({{0.2, disc(3, 1)}, {0.3, disc(4, 1)}, {0.5, disc(5, 1)}}).value();

  const std::vector<Gaussian> terminals = terminals_of({world, start, goal});

  ASSERT_EQ(terminals.size(), 5U);
  for (std::size_t i = 0; i < terminals.size(); ++i) {
    EXPECT_EQ(terminals[i].mean_m(), Vec2(1.0 + static_cast<double>(i), 1));
  }
}

TEST(FlowOf, HasASourceAndASinkForEachComponentInOrder) {
  const World world = World::make({{0, 0}, {60, 60}}, {}).value();
  const Mixture start = Mixture::make({{0.25, disc(0, 0)}, {0.75, disc(0, 50)}}).value();
  const Mixture goal = Mixture::make({{0.25, disc(3, 4, 3.0)}, {0.75, disc(10, 50)}}).value();

  const auto flow = flow_of(two_routes(), {world, start, goal}, {});

  ASSERT_TRUE(flow.has_value()) << flow.error().message;
  ASSERT_EQ(flow->sources().size(), 2U);
  ASSERT_EQ(flow->sinks().size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const PlanNode& source = flow->nodes()[flow->sources()[i]];
    const PlanNode& sink = flow->nodes()[flow->sinks()[i]];
    EXPECT_EQ(source.gaussian.mean_m(), start.components()[i].gaussian.mean_m());
    EXPECT_EQ(sink.gaussian.mean_m(), goal.components()[i].gaussian.mean_m());
    EXPECT_NEAR(source.mass, start.components()[i].weight, 1e-12);
    EXPECT_NEAR(sink.mass, goal.components()[i].weight, 1e-12);
  }
}

}  // namespace
}  // namespace swarm::planner
