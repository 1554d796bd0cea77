// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/keeper/replan.hpp"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "planner_service/plan_checks.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "tests/unit/planner_service/planners.hpp"
#include "tests/unit/planner_service/robots_in_flight.hpp"
#include "tests/unit/planner_service/standin_scene.hpp"

namespace swarm::planner {
namespace {

const test::StandinScene& scene() {
  static const test::StandinScene s = test::standin_scene();
  return s;
}

TEST(Replan, GivesEveryRobotAnEntryThatMakesTheCountsComeOutRight) {
  const auto robots = test::robots_in_flight(200);
  Rng rng(3);
  Planner planner = test::swarmprm_planner();
  const auto anew =
      replan(planner, {scene().world, scene().goal, robots}, 200, {rng, &test::no_time});
  ASSERT_TRUE(anew.has_value()) << anew.error().message;
  const FlowPlan& flow = anew->planned.plan;
  ASSERT_EQ(anew->entries.size(), 200U);

  // Robots that follow their draws to the sinks, as an agent does.
  std::vector<double> at_goal(3, 0.0);
  for (const PlanEntry& entry : anew->entries) {
    ASSERT_LT(entry.source, flow.sources().size());
    std::uint32_t node = flow.sources()[entry.source];
    double share = entry.share / 65536.0;
    while (!flow.legs_out(node).empty()) {
      double total = 0.0;
      for (const auto leg : flow.legs_out(node)) total += flow.legs()[leg].mass;
      double target = share * total;
      for (const auto leg : flow.legs_out(node)) {
        const double mass = flow.legs()[leg].mass;
        if (target < mass || leg == flow.legs_out(node).back()) {
          share = target / mass;
          node = flow.legs()[leg].to;
          break;
        }
        target -= mass;
      }
    }
    for (std::size_t j = 0; j < 3; ++j) at_goal[j] += flow.sinks()[j] == node ? 1.0 : 0.0;
  }
  // Within one robot for each source that splits: at most two do, since the transport is basic.
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_NEAR(at_goal[j], 200.0 * scene().goal.components()[j].weight, 2.0);
  }
}

TEST(Replan, FindsAPathAroundAnObstacleThatWasDropped) {
  const auto robots = test::robots_in_flight(100);
  std::vector<Obstacle> obstacles = scene().world.obstacles();
  obstacles.push_back(Circle{{100, 50}, 5.0});
  const World world = World::make(scene().world.bounds_m(), obstacles).value();
  Rng rng(4);

  Planner planner = test::swarmprm_planner();
  const auto anew = replan(planner, {world, scene().goal, robots}, 100, {rng, &test::no_time});

  ASSERT_TRUE(anew.has_value()) << anew.error().message;
  EXPECT_LE(planned_max_cvar_m(anew->planned.plan, world, 0.05), -0.2 + 1e-3);
}

TEST(Replan, RefusesAGoalThatWasBuriedAndNamesIt) {
  const auto robots = test::robots_in_flight(20);
  std::vector<Obstacle> obstacles = scene().world.obstacles();
  obstacles.push_back(Circle{{175, 60}, 5.0});
  const World world = World::make(scene().world.bounds_m(), obstacles).value();
  Rng rng(4);

  Planner planner = test::swarmprm_planner();
  const auto anew = replan(planner, {world, scene().goal, robots}, 20, {rng, &test::no_time});

  ASSERT_FALSE(anew.has_value());
  EXPECT_EQ(anew.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(anew.error().message.find("goal component 1"), std::string::npos)
      << anew.error().message;
}

}  // namespace
}  // namespace swarm::planner
