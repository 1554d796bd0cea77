// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The contract of all planning methods, and the state that Planner keeps from one plan to the next.
#include <gtest/gtest.h>

#include "planner_service/flow/plan_density.hpp"
#include "planner_service/keeper/replan.hpp"
#include "planner_service/plan_checks.hpp"
#include "swarm_core/risk/mixture_cvar.hpp"
#include "swarmflow/mission/mission.hpp"
#include "tests/unit/planner_service/planners.hpp"
#include "tests/unit/planner_service/standin_scene.hpp"

namespace swarm::planner {
namespace {

const test::StandinScene& scene() {
  static const test::StandinScene s = test::standin_scene();
  return s;
}

Mission mission_of(const char* method) {
  Mission mission;
  mission.world = scene().world;
  mission.start = scene().start;
  mission.goal = scene().goal;
  mission.planner.method = method;
  mission.planner.options.set("connection_radius_m", 20.0);
  return mission;
}

class Methods : public ::testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(All, Methods, ::testing::Values("swarmprm", "rover", "crops", "adoc"),
                         [](const auto& method) { return std::string(method.param); });

TEST_P(Methods, EndInAFlowBetweenTheMixturesOfTheMission) {
  Rng rng(1);
  const auto planned = test::plan_mission(mission_of(GetParam()), rng);

  ASSERT_TRUE(planned.has_value()) << planned.error().message;
  const FlowPlan& flow = planned->plan;
  ASSERT_EQ(flow.sources().size(), 4U);
  ASSERT_EQ(flow.sinks().size(), 3U);
  for (std::size_t i = 0; i < 4; ++i) {
    const PlanNode& node = flow.nodes()[flow.sources()[i]];
    EXPECT_EQ(node.gaussian.mean_m(), scene().start.components()[i].gaussian.mean_m());
    EXPECT_NEAR(node.mass, scene().start.components()[i].weight, 1e-6);
  }
  for (std::size_t j = 0; j < 3; ++j) {
    const PlanNode& node = flow.nodes()[flow.sinks()[j]];
    EXPECT_EQ(node.gaussian.mean_m(), scene().goal.components()[j].gaussian.mean_m());
    EXPECT_NEAR(node.mass, scene().goal.components()[j].weight, 1e-6);
  }
  EXPECT_GT(planned->stats.planned_mean_path_m, test::kStandinMeanBound_m);
  // Means do not pass through obstacles, whatever the method promises about their spread.
  for (const PlanLeg& leg : flow.legs()) {
    EXPECT_TRUE(scene().world.segment_is_free(flow.nodes()[leg.from].gaussian.mean_m(),
                                              flow.nodes()[leg.to].gaussian.mean_m(), 0.0));
  }
}

TEST(Methods, KeepWhatTheyPromiseAboutRisk) {
  const auto flow_of = [](const char* method) {
    Rng rng(2);
    return test::plan_mission(mission_of(method), rng).value().plan;
  };
  EXPECT_LE(planned_max_cvar_m(flow_of("swarmprm"), scene().world, 0.05), -0.2 + 1e-3);
  EXPECT_LE(planned_max_cvar_m(flow_of("crops"), scene().world, 0.05), -0.2 + 1e-3);
  // ROVER's (11g) at its steps; where its times lie close the report's grid holds them too.
  const FlowPlan rover = flow_of("rover");
  for (const PlanNode& node : rover.nodes()) {
    EXPECT_LE(max_mixture_cvar_m(rover.mixture_at(node.time), scene().world, 0.05), -0.2 + 1e-6);
  }
}

TEST(Planner, KeepsToTheDensityCapInTime) {
  Mission mission = mission_of("swarmprm");
  mission.robots.count = 500;
  mission.planner.density_cap_per_m2 = 1.5;
  Rng rng(1);

  const auto timed = test::plan_mission(mission, rng);
  mission.planner.options.set("density_cap", "static");
  const auto by_node = test::plan_mission(mission, rng);

  ASSERT_TRUE(timed.has_value()) << timed.error().message;
  EXPECT_LE(max_density(timed->plan, 500.0, 0.5).per_m2, 1.5 + 1e-9);
  ASSERT_FALSE(by_node.has_value());
  EXPECT_EQ(by_node.error().code, ErrorCode::kInfeasible);
}

class KeptPlanners : public ::testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(All, KeptPlanners, ::testing::Values("swarmprm", "rover", "crops"),
                         [](const auto& method) { return std::string(method.param); });

TEST_P(KeptPlanners, FollowTheMapTheGoalAndTheRisk) {
  Planner planner = test::planner_of(mission_of(GetParam()));
  Rng rng(1);
  const auto plan_in = [&](const World& world, const Mixture& goal) {
    const auto planned = planner.plan({world, scene().start, goal}, {rng, &test::no_time});
    EXPECT_TRUE(planned.has_value()) << planned.error().message;
    return planned.has_value() ? planned->plan : FlowPlan{};
  };
  const auto keeps = [&](const FlowPlan& flow, const World& world) {
    for (const PlanLeg& leg : flow.legs()) {
      if (!world.segment_is_free(flow.nodes()[leg.from].gaussian.mean_m(),
                                 flow.nodes()[leg.to].gaussian.mean_m(), 0.0)) {
        return false;
      }
    }
    return !flow.empty();
  };
  EXPECT_TRUE(keeps(plan_in(scene().world, scene().goal), scene().world));
  std::vector<Obstacle> obstacles = scene().world.obstacles();
  obstacles.push_back(Circle{{100, 50}, 5.0});
  const World fuller = World::make(scene().world.bounds_m(), obstacles).value();
  EXPECT_TRUE(keeps(plan_in(fuller, scene().goal), fuller));
  const Mixture elsewhere =
      Mixture::make({{1.0, Gaussian::from_parameters({100, 110}, 2.0, 2.0, 0.0)}}).value();
  const FlowPlan there = plan_in(fuller, elsewhere);
  EXPECT_TRUE(keeps(there, fuller));
  ASSERT_EQ(there.sinks().size(), 1U);
  planner.set_risk({.alpha = 0.3, .delta_m = -0.2});
  EXPECT_TRUE(keeps(plan_in(scene().world, scene().goal), scene().world));
}

TEST_P(KeptPlanners, PlanAnewFromTheRobotPositions) {
  Planner planner = test::planner_of(mission_of(GetParam()));
  Rng rng(1);
  const auto first =
      planner.plan({scene().world, scene().start, scene().goal}, {rng, &test::no_time});
  ASSERT_TRUE(first.has_value()) << first.error().message;
  const Mixture half_way = first->plan.mixture_at(0.4 * first->plan.duration());
  std::vector<ReportedRobot> robots;
  while (robots.size() < 60) {
    const double u = (static_cast<double>(robots.size()) + 0.5) / 60.0;
    const Gaussian& g = half_way.components()[half_way.component_at(u)].gaussian;
    const double z = standard_normal(rng);
    const Vec2 p = g.mean_m() + cholesky_lower(g.covariance_m2()) * Vec2(z, standard_normal(rng));
    if (!scene().world.is_clear(p, 0.25) || !scene().world.bounds_m().contains(p)) continue;
    robots.push_back({RobotId(static_cast<std::uint32_t>(robots.size())), p, false});
  }

  const auto anew =
      replan(planner, {scene().world, scene().goal, robots}, 60, {rng, &test::no_time});

  ASSERT_TRUE(anew.has_value()) << anew.error().message;
  for (const PlanEntry& entry : anew->entries) {
    EXPECT_LT(entry.source, anew->planned.plan.sources().size());
  }
}

}  // namespace
}  // namespace swarm::planner
