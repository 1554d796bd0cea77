// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/robot/route.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "swarm_core/mission/placement.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::agent {
namespace {

PlanNode node(Vec2 mean, double sigma, double time, double mass) {
  return {Gaussian::from_parameters(mean, sigma, sigma, 0.0), MissionTime(time), mass};
}

/// Two sources, a split behind the first, three sinks:   0 ─.25─▶ 2      1 ─.5─▶ 4
///                                                       └──.25─▶ 3
FlowPlan branching_plan() {
  auto plan = FlowPlan::make(
      {node({0, 0}, 2, 0, 0.5), node({0, 20}, 2, 0, 0.5), node({30, -5}, 2, 20, 0.25),
       node({30, 5}, 2, 20, 0.25), node({30, 20}, 2, 20, 0.5)},
      {{0, 2, 0.25}, {0, 3, 0.25}, {1, 4, 0.5}});
  EXPECT_TRUE(plan.has_value());
  return *plan;
}

World empty_world() { return *World::make({{-50, -50}, {80, 80}}, {}); }

TEST(Route, CountsOnEveryLegComeOutRightWithoutCommunication) {
  const FlowPlan plan = branching_plan();
  const World world = empty_world();
  for (const std::uint32_t robots : {4U, 10U, 100U, 500U}) {
    std::vector<double> count(3, 0.0);
    for (std::uint32_t i = 0; i < robots; ++i) {
      const double share = stratified_share(i, robots);
      count.at(route_from_start(plan, share, {0, 0}, world, {}).sink) += 1.0;
    }
    EXPECT_NEAR(count[0], 0.25 * robots, 1.0);
    EXPECT_NEAR(count[1], 0.25 * robots, 1.0);
    EXPECT_NEAR(count[2], 0.50 * robots, 1.0);
  }
}

TEST(Route, EndsInsideTheGoalsEllipseFromWhereverItStarts) {
  const FlowPlan plan = branching_plan();
  const World world = empty_world();
  Rng rng(5);
  for (int i = 0; i < 200; ++i) {
    const Vec2 start(uniform(rng, -15, 15), uniform(rng, -15, 15));

    const Route route = route_from_start(plan, uniform01(rng), start, world, {});

    EXPECT_TRUE(route.goal.contains_99(route.path.vertices_m().back()));
  }
}

// A circle where a lost robot may be covers most of the goal: 5 of its 6.07 m.
TEST(Route, EndsInsideTheGoalsEllipseBesideBodiesThatLeaveRoom) {
  const FlowPlan plan = branching_plan();
  const Gaussian& goal = plan.nodes()[4].gaussian;
  Rng rng(7);
  for (int i = 0; i < 200; ++i) {
    const Circle body{goal.mean_m() + Vec2(uniform(rng, -4, 4), uniform(rng, -4, 4)),
                      uniform(rng, 0.2, 5.0)};
    const World world = *World::make({{-50, -50}, {80, 80}}, {body}, {}, 1);
    const Vec2 start(uniform(rng, -6, 6), uniform(rng, 14, 26));

    const Route route = route_from_source(plan, 1, uniform01(rng), start, world, {});

    const Vec2& end_m = route.path.vertices_m().back();
    EXPECT_GE(world.distance_m(end_m), 0.2) << i;
    // Room: the ring between body and ellipse is wide enough at its widest, towards the mean.
    const double room_m = 6.07 + (body.center_m - goal.mean_m()).norm() - body.radius_m;
    if (room_m > 1.0) {
      EXPECT_TRUE(route.goal.contains_99(end_m)) << i << ' ' << body.radius_m;
    }
  }
}

/// The path of a robot of this radius past a corner.
Route route_past_a_corner(double radius_m, const World& world) {
  const auto plan =
      FlowPlan::make({node({0, 0}, 2, 0, 1), node({15, 9}, 2, 10, 1), node({30, 0}, 2, 20, 1)},
                     {{0, 1, 1}, {1, 2, 1}});
  return route_from_start(*plan, 0.5, {0, 0}, world, RouteOptions{.radius_m = radius_m});
}

TEST(Route, KeepsLargeRobotsFartherFromObstacles) {
  const auto block = Polygon::make({{12, -3}, {18, -3}, {18, 3}, {12, 3}});
  const World world = *World::make({{-50, -50}, {80, 80}}, {*block});
  const Route route = route_past_a_corner(1.0, world);
  const auto& v = route.path.vertices_m();
  for (std::size_t k = 0; k + 1 < v.size(); ++k) {
    EXPECT_TRUE(world.segment_is_free(v[k], v[k + 1], 1.29));
  }
}

TEST(Route, KeepsItsClearanceAtObstacles) {
  const auto block = Polygon::make({{12, -3}, {18, -3}, {18, 3}, {12, 3}});
  ASSERT_TRUE(block.has_value());
  const World world = *World::make({{-50, -50}, {80, 80}}, {*block});
  const auto plan =
      FlowPlan::make({node({0, 0}, 2, 0, 1), node({15, 9}, 2, 10, 1), node({30, 0}, 2, 20, 1)},
                     {{0, 1, 1}, {1, 2, 1}});
  ASSERT_TRUE(plan.has_value());
  Rng rng(6);
  for (int i = 0; i < 100; ++i) {
    const Vec2 start(uniform(rng, -6, 6), uniform(rng, -6, 6));

    const Route route = route_from_start(*plan, 0.5, start, world, {});

    const auto& v = route.path.vertices_m();
    for (std::size_t k = 0; k + 1 < v.size(); ++k)
      EXPECT_TRUE(world.segment_is_free(v[k], v[k + 1], 0.49));
  }
}

TEST(Route, LeadsToTheOnlyNodeOfAPlanWithoutLegs) {
  const auto plan = FlowPlan::make({node({10, 0}, 2, 0, 1.0)}, {});
  ASSERT_TRUE(plan.has_value());

  const Route route = route_from_here(*plan, 0.5, {0, 0}, empty_world(), {});

  EXPECT_EQ(route.sink, 0U);
  EXPECT_TRUE(route.goal.contains_99(route.path.vertices_m().back()));
}

TEST(Route, JoinsADifferentPlanWhereItPassesNearest) {
  const FlowPlan plan = branching_plan();

  const Route route = route_from_here(plan, 0.1, {15, 20}, empty_world(), {});

  EXPECT_EQ(route.sink, 2U);
  EXPECT_LT((route.path.vertices_m().front() - Vec2(15, 20)).norm(), 1.0);
  EXPECT_LT(route.path.length_m(), 16.0);
}

}  // namespace
}  // namespace swarm::agent
