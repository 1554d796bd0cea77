// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/merge_routes.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "planner_service/flow/build_plan.hpp"
#include "swarm_core/gmm/same_gaussian.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::planner {
namespace {

Gaussian at(double x, double y) { return Gaussian::from_parameters({x, y}, 1.0, 1.0, 0.0); }

// The node of the plan at the end of a leg from one of `nodes` whose Gaussian is `next`.
std::vector<std::uint32_t> step(const FlowPlan& plan, const std::vector<std::uint32_t>& nodes,
                                const Gaussian& next) {
  std::vector<std::uint32_t> reached;
  for (const PlanLeg& leg : plan.legs()) {
    if (std::count(nodes.begin(), nodes.end(), leg.from) == 0) continue;
    if (same(plan.nodes()[leg.to].gaussian, next)) reached.push_back(leg.to);
  }
  return reached;
}

TEST(MergeRoutes, SharesTheStretchThatTwoRoutesHaveInCommon) {
  //  0 ──┐
  //      a ── b ── goal
  //  1 ──┘
  const Gaussian s0 = at(0, 0);
  const Gaussian s1 = at(0, 30);
  const Gaussian a = at(30, 10);
  const Gaussian b = at(60, 10);
  const Gaussian goal = at(90, 10);
  const std::vector<Route> routes{{0, 0, 0.4, {s0, a, b, goal}}, {1, 0, 0.6, {s1, a, b, goal}}};

  const auto plan = build_merged_plan(routes, 2, 1, {2.0});
  const auto apart = build_plan(routes, 2, 1, {2.0});

  ASSERT_TRUE(plan.has_value()) << plan.error().message;
  EXPECT_EQ(plan->nodes().size(), 5U);
  EXPECT_EQ(plan->legs().size(), 4U);
  EXPECT_EQ(apart->nodes().size(), 7U);
  EXPECT_EQ(plan->duration(), apart->duration());
  EXPECT_DOUBLE_EQ(plan->nodes()[3].mass, 1.0);
  // The second route is the longer one, so that it keeps its times.
  EXPECT_DOUBLE_EQ(plan->nodes()[3].time.count(), std::hypot(30.0, 20.0) / 2.0);
  EXPECT_EQ(plan->mixture_at(MissionTime(1)).components().size(), 2U);
  EXPECT_EQ(plan->mixture_at(MissionTime(30)).components().size(), 1U);
}

TEST(MergeRoutes, DelaysNoRouteToMerge) {
  // Route 0 passes the crossing early and has a long path behind it, route 1 reaches it late.
  const Gaussian crossing = at(10, 0);
  const std::vector<Route> routes{{0, 0, 0.5, {at(0, 0), crossing, at(90, 0)}},
                                  {1, 1, 0.5, {at(10, 70), crossing, at(10, -10)}}};

  const auto plan = build_merged_plan(routes, 2, 2, {1.0});
  const auto apart = build_plan(routes, 2, 2, {1.0});

  ASSERT_TRUE(plan.has_value());
  EXPECT_EQ(plan->nodes().size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(plan->nodes()[i].time.count(), apart->nodes()[i].time.count(), 1e-12);
  }
}

TEST(MergeRoutes, KeepsRoutesApartThatRunAgainstEachOther) {
  const Gaussian a = at(10, 0);
  const Gaussian b = at(20, 0);
  const std::vector<Route> routes{{0, 0, 0.5, {at(0, 0), a, b, at(30, 0)}},
                                  {1, 1, 0.5, {at(30, 5), b, a, at(0, 5)}}};

  const auto plan = build_merged_plan(routes, 2, 2, {1.0});

  // At most one of the two nodes is merged: merging both would close a cycle.
  ASSERT_TRUE(plan.has_value()) << plan.error().message;
  EXPECT_GE(plan->nodes().size(), 7U);
}

TEST(MergeRoutes, IsBuildPlanWithoutAnythingInCommon) {
  const Gaussian goal = at(40, 0);
  const std::vector<Route> routes{{0, 0, 0.5, {at(0, 0), at(10, 0), at(25, 5), goal}},
                                  {1, 0, 0.3, {at(0, 30), at(10, 20), goal}},
                                  {1, 1, 0.2, {at(0, 30), at(7, 7)}}};

  const auto plan = build_merged_plan(routes, 2, 2, {2.0});
  const auto apart = build_plan(routes, 2, 2, {2.0});

  ASSERT_TRUE(plan.has_value()) << plan.error().message;
  ASSERT_EQ(plan->nodes().size(), apart->nodes().size());
  for (std::size_t i = 0; i < plan->nodes().size(); ++i) {
    EXPECT_TRUE(same(plan->nodes()[i].gaussian, apart->nodes()[i].gaussian));
    EXPECT_NEAR(plan->nodes()[i].time.count(), apart->nodes()[i].time.count(), 1e-12);
    EXPECT_EQ(plan->nodes()[i].mass, apart->nodes()[i].mass);
  }
}

TEST(MergeRoutes, KeepsEveryRouteSpeedAndArrivalOnRandomGrids) {
  constexpr double kSpeed_mps = 1.5;
  std::size_t nodes_apart = 0;
  std::size_t nodes_merged = 0;
  Rng rng(1);
  for (int round = 0; round < 100; ++round) {
    // Routes from three starts on the left to two goals on the right over a few shared nodes.
    std::vector<Route> routes;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 2; ++j) {
        Route route{i, j, 1.0 / 6.0, {at(0, 20.0 * static_cast<double>(i))}};
        const std::size_t columns = 2 + rng() % 4;
        for (std::size_t c = 1; c <= columns; ++c) {
          route.waypoints.push_back(
              at(10.0 * static_cast<double>(c), 15.0 * static_cast<double>(rng() % 3)));
        }
        route.waypoints.push_back(at(70, 30.0 * static_cast<double>(j)));
        routes.push_back(route);
      }
    }
    const auto apart = build_plan(routes, 3, 2, {kSpeed_mps}).value();

    const auto plan = build_merged_plan(routes, 3, 2, {kSpeed_mps});

    ASSERT_TRUE(plan.has_value()) << plan.error().message;
    ASSERT_EQ(plan->sources().size(), 3U);
    ASSERT_EQ(plan->sinks().size(), 2U);
    for (std::size_t j = 0; j < 2; ++j) {
      EXPECT_NEAR(plan->nodes()[plan->sinks()[j]].time.count(),
                  apart.nodes()[apart.sinks()[j]].time.count(), 1e-9);
      EXPECT_NEAR(plan->nodes()[plan->sinks()[j]].mass, 0.5, 1e-12);
    }
    for (const PlanLeg& leg : plan->legs()) {
      const PlanNode& from = plan->nodes()[leg.from];
      const PlanNode& to = plan->nodes()[leg.to];
      EXPECT_GE((to.time - from.time).count(),
                leg_duration_s(from.gaussian, to.gaussian, kSpeed_mps) - 1e-9);
    }
    for (const Route& route : routes) {
      std::vector<std::uint32_t> reached{plan->sources()[route.from]};
      for (std::size_t i = 1; i < route.waypoints.size(); ++i) {
        reached = step(*plan, reached, route.waypoints[i]);
      }
      EXPECT_EQ(std::count(reached.begin(), reached.end(), plan->sinks()[route.to]) > 0, true);
    }
    nodes_apart += apart.nodes().size();
    nodes_merged += plan->nodes().size();
  }
  EXPECT_LT(nodes_merged, 4 * nodes_apart / 5);
}

}  // namespace
}  // namespace swarm::planner
