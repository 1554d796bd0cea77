// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/build_plan.hpp"

#include <gtest/gtest.h>

namespace swarm::planner {
namespace {

Gaussian at(double x, double y) { return Gaussian::from_parameters({x, y}, 1.0, 1.0, 0.0); }

TEST(BuildPlan, SharesSourcesAndSinksAndKeepsTheirOrder) {
  const Gaussian s0 = at(0, 0);
  const Gaussian s1 = at(0, 50);
  const Gaussian g0 = at(100, 0);
  const Gaussian g1 = at(100, 50);
  // Goal 1 comes first in the list of routes, and start 1 feeds both goals.
  const std::vector<Route> routes{
      {1, 1, 0.5, {s1, g1}}, {1, 0, 0.2, {s1, at(40, 30), g0}}, {0, 0, 0.3, {s0, at(50, 0), g0}}};

  const auto plan = build_plan(routes, 2, 2, {2.0});

  ASSERT_TRUE(plan.has_value()) << plan.error().message;
  ASSERT_EQ(plan->sources().size(), 2U);
  ASSERT_EQ(plan->sinks().size(), 2U);
  EXPECT_EQ(plan->nodes()[plan->sources()[0]].gaussian.mean_m(), s0.mean_m());
  EXPECT_EQ(plan->nodes()[plan->sources()[1]].gaussian.mean_m(), s1.mean_m());
  EXPECT_EQ(plan->nodes()[plan->sinks()[0]].gaussian.mean_m(), g0.mean_m());
  EXPECT_EQ(plan->nodes()[plan->sinks()[1]].gaussian.mean_m(), g1.mean_m());
  EXPECT_DOUBLE_EQ(plan->nodes()[plan->sources()[1]].mass, 0.7);
  EXPECT_DOUBLE_EQ(plan->nodes()[plan->sinks()[0]].mass, 0.5);
  EXPECT_EQ(plan->legs().size(), 5U);
}

TEST(BuildPlan, ArrivesWithTheSlowestAndStretchesTheOthers) {
  const Gaussian s0 = at(0, 0);
  const Gaussian s1 = at(0, 30);
  const Gaussian goal = at(40, 0);
  const std::vector<Route> routes{{0, 0, 0.5, {s0, at(10, 0), goal}}, {1, 0, 0.5, {s1, goal}}};

  const auto plan = build_plan(routes, 2, 1, {2.0});

  ASSERT_TRUE(plan.has_value()) << plan.error().message;
  // The second route is 50 m long and takes 25 s; the first, 40 m, is stretched from 20 s.
  EXPECT_DOUBLE_EQ(plan->duration().count(), 25.0);
  EXPECT_DOUBLE_EQ(plan->nodes()[3].time.count(), 25.0 * 10.0 / 40.0);
}

TEST(BuildPlan, GivesTimeToGaussiansThatOnlyChangeShape) {
  const Gaussian wide = Gaussian::from_parameters({0, 0}, 7.0, 5.0, 0.0);
  const std::vector<Route> reshape{{0, 0, 1.0, {wide, Gaussian::from_parameters({0, 0}, 4, 1, 0)}}};
  const std::vector<Route> stay{{0, 0, 1.0, {wide, wide}}};

  const auto reshaped = build_plan(reshape, 1, 1, {2.0});
  const auto stayed = build_plan(stay, 1, 1, {2.0});

  ASSERT_TRUE(reshaped.has_value());
  ASSERT_TRUE(stayed.has_value()) << stayed.error().message;
  EXPECT_NEAR(reshaped->duration().count(), 2.5, 1e-9);  // √(3² + 4²) m at 2 m/s
  EXPECT_GT(stayed->duration().count(), 0.0);
}

}  // namespace
}  // namespace swarm::planner
