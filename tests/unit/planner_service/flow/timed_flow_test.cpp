// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/timed_flow.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "planner_service/flow/capped_flow.hpp"
#include "planner_service/flow/plan_density.hpp"
#include "planner_service/plan_checks.hpp"
#include "planner_service/roadmap/connect.hpp"
#include "tests/unit/planner_service/flow/flow_scene.hpp"
#include "tests/unit/planner_service/planners.hpp"
#include "tests/unit/planner_service/standin_scene.hpp"

namespace swarm::planner {
namespace {

using test::flow_scene;
using test::FlowScene;

// Evaluates the mixture alone, on a grid and at the means, between the times the planner sampled.
double sampled_density_per_m2(const FlowPlan& plan, double robots, double step_s) {
  double highest = 0.0;
  for (double t = 0.0; t < plan.duration().count() + step_s; t += step_s) {
    const Mixture mixture = plan.mixture_at(MissionTime(t));
    for (const WeightedGaussian& component : mixture.components()) {
      for (const Vec2& off_m :
           {Vec2(0, 0), Vec2(0.5, 0), Vec2(-0.5, 0), Vec2(0, 0.5), Vec2(0, -0.5)}) {
        const Vec2 at_m = component.gaussian.mean_m() + off_m;
        highest = std::max(highest, robots * mixture.density(at_m));
      }
    }
  }
  return highest;
}

void expect_ends_of(const FlowPlan& plan, const Roadmap& roadmap, std::span<const double> supplies,
                    std::span<const double> demands) {
  ASSERT_EQ(plan.sources().size(), supplies.size());
  ASSERT_EQ(plan.sinks().size(), demands.size());
  for (std::size_t i = 0; i < supplies.size(); ++i) {
    const PlanNode& source = plan.nodes()[plan.sources()[i]];
    EXPECT_EQ(source.gaussian.mean_m(), roadmap.nodes[i].mean_m());
    EXPECT_EQ(source.time.count(), 0.0);
    EXPECT_NEAR(source.mass, supplies[i], 1e-9);
  }
  for (std::size_t j = 0; j < demands.size(); ++j) {
    const PlanNode& sink = plan.nodes()[plan.sinks()[j]];
    EXPECT_EQ(sink.gaussian.mean_m(), roadmap.nodes[supplies.size() + j].mean_m());
    EXPECT_NEAR(sink.mass, demands[j], 1e-9);
  }
}

TEST(TimedFlow, KeepsTheCapWhereThePassageIsTooNarrowForAllAtOnce) {
  int refused_at_once = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    FlowScene scene = flow_scene(seed, 30, 16.0, 1.5);
    const DensityCap cap{.max_per_m2 = 1.0, .robots = 120.0};
    EdgeChecker checker(scene.world, scene.risk);
    const bool fits_at_once =
        capped_flow(scene.roadmap, scene.supplies, scene.demands, cap, checker).has_value();

    const auto flow = timed_flow(scene.roadmap, scene.supplies, scene.demands, cap, {}, checker);

    refused_at_once += fits_at_once ? 0 : 1;
    ASSERT_TRUE(flow.has_value()) << "seed " << seed << ": " << flow.error().message;
    expect_ends_of(flow->plan, scene.roadmap, scene.supplies, scene.demands);
    EXPECT_LE(flow->max_density_per_m2, cap.max_per_m2);
    // Between the planner's samples a mean moves 0.3 m, next to nothing beside 0.7 m of deviation.
    EXPECT_LE(sampled_density_per_m2(flow->plan, cap.robots, 0.31), 1.01 * cap.max_per_m2);
  }
  EXPECT_GT(refused_at_once, 5);
}

TEST(TimedFlow, MovesNoFasterThanItMay) {
  const FlowScene scene = flow_scene(3, 60);
  EdgeChecker checker(scene.world, scene.risk);

  const auto flow =
      timed_flow(scene.roadmap, scene.supplies, scene.demands, {.max_per_m2 = 1.0, .robots = 100.0},
                 {.speed = {.means_mps = 0.8}}, checker);

  ASSERT_TRUE(flow.has_value()) << flow.error().message;
  for (const PlanLeg& leg : flow->plan.legs()) {
    const PlanNode& from = flow->plan.nodes()[leg.from];
    const PlanNode& to = flow->plan.nodes()[leg.to];
    const double path_m = (to.gaussian.mean_m() - from.gaussian.mean_m()).norm();
    EXPECT_LE(path_m, 0.8 * (to.time - from.time).count() + 1e-9);
  }
}

TEST(TimedFlow, PassesFiveHundredRobotsWhereTheStaticCapHasNoFlow) {
  const test::StandinScene scene = test::standin_scene();
  SwarmPrmOptions options;
  options.samples = 300;
  options.shortcuts = 0;
  Rng rng(1);
  auto planned = test::plan_once({scene.world, scene.start, scene.goal}, options, rng);
  ASSERT_TRUE(planned.has_value());
  const std::vector<double> supplies{0.25, 0.375, 0.1875, 0.1875};
  const std::vector<double> demands{0.25, 0.375, 0.375};
  const DensityCap cap{.max_per_m2 = 1.5, .robots = 500.0};
  EdgeChecker checker(scene.world, options.risk);

  const auto at_once = capped_flow(planned->roadmap, supplies, demands, cap, checker);
  const auto timed = timed_flow(planned->roadmap, supplies, demands, cap, {}, checker);

  ASSERT_FALSE(at_once.has_value());
  EXPECT_EQ(at_once.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(at_once.error().message.find("fit through the roadmap at the same time"),
            std::string::npos);
  ASSERT_TRUE(timed.has_value()) << timed.error().message;
  expect_ends_of(timed->plan, planned->roadmap, supplies, demands);
  EXPECT_LE(sampled_density_per_m2(timed->plan, 500.0, 0.7), 1.01 * cap.max_per_m2);
  EXPECT_GT(max_density(planned->plan, 500.0, 0.7).per_m2, 5.0);  // without a cap
  EXPECT_GE(timed->cost_m, planned->stats.cost_m - 1e-6);         // nothing is shorter
  EXPECT_LE(timed->cost_m, 1.05 * planned->stats.cost_m);
  EXPECT_LE(planned_max_cvar_m(timed->plan, scene.world, options.risk.alpha),
            options.risk.delta_m + kPlanTolerance_m);
}

TEST(TimedFlow, RefusesAStartThatIsTooDense) {
  const FlowScene scene = flow_scene(1, 30);
  EdgeChecker checker(scene.world, scene.risk);

  const auto flow = timed_flow(scene.roadmap, scene.supplies, scene.demands,
                               {.max_per_m2 = 0.5, .robots = 100.0}, {}, checker);

  ASSERT_FALSE(flow.has_value());
  EXPECT_EQ(flow.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(flow.error().message.find("start component 1"), std::string::npos);
}

TEST(TimedFlow, RefusesComponentsThatAreTooDenseTogether) {
  FlowScene scene = flow_scene(1, 30);
  // Both starts at one place: 0.4 and 0.6 robots/m2 add up.
  scene.roadmap.nodes[1] = scene.roadmap.nodes[0];
  EdgeChecker checker(scene.world, scene.risk);

  const auto flow = timed_flow(scene.roadmap, scene.supplies, scene.demands,
                               {.max_per_m2 = 0.8, .robots = 100.0}, {}, checker);

  ASSERT_FALSE(flow.has_value());
  EXPECT_NE(flow.error().message.find("0.995 robots/m2 at (5.0, 8.0) m"), std::string::npos)
      << flow.error().message;
}

TEST(TimedFlow, RefusesNetworksThatTakeMinutes) {
  const FlowScene scene = flow_scene(1, 60);
  EdgeChecker checker(scene.world, scene.risk);

  const auto flow = timed_flow(scene.roadmap, scene.supplies, scene.demands,
                               {.max_per_m2 = 1.0, .robots = 100.0}, {.step_s = 1e-3}, checker);

  ASSERT_FALSE(flow.has_value());
  EXPECT_NE(flow.error().message.find("arcs, more than"), std::string::npos);
}

TEST(TimedFlow, ReportsHowManyFitWhenTimeIsShort) {
  const FlowScene scene = flow_scene(1, 30, 16.0, 1.5);
  EdgeChecker checker(scene.world, scene.risk);

  const auto flow = timed_flow(scene.roadmap, scene.supplies, scene.demands,
                               {.max_per_m2 = 1.0, .robots = 130.0}, {.stretch_max = 1.0}, checker);

  ASSERT_FALSE(flow.has_value());
  EXPECT_EQ(flow.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(flow.error().message.find("% of the swarm fit"), std::string::npos)
      << flow.error().message;
}

TEST(TimedFlow, ReportsWhenNoPathExists) {
  const FlowScene scene = flow_scene(1, 0);
  EdgeChecker checker(scene.world, scene.risk);

  const auto flow = timed_flow(scene.roadmap, scene.supplies, scene.demands,
                               {.max_per_m2 = 10.0, .robots = 100.0}, {}, checker);

  ASSERT_FALSE(flow.has_value());
  EXPECT_NE(flow.error().message.find("at any density"), std::string::npos);
}

}  // namespace
}  // namespace swarm::planner
