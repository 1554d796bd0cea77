// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/replan.hpp"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "planner_service/plan_checks.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "tests/unit/planner_service/standin_scene.hpp"

namespace swarm::planner {
namespace {

const testing::StandinScene& scene() {
  static const testing::StandinScene s = testing::standin_scene();
  return s;
}

SteadyTime no_time() { return {}; }

/// Robots spread along a plan that is half done, as far from obstacles as robots are.
std::vector<HeardRobot> robots_in_flight(std::uint32_t count) {
  Rng rng(1);
  const auto planned = plan({scene().world, scene().start, scene().goal}, {}, rng, &no_time);
  EXPECT_TRUE(planned.has_value());
  std::vector<HeardRobot> robots;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double at = uniform(rng, 0.1, 0.8);
    const Mixture mixture = planned->plan.mixture_at(at * planned->plan.duration());
    for (;;) {
      const Gaussian& g = mixture.components()[mixture.component_at((i + 0.5) / count)].gaussian;
      const double u = standard_normal(rng);
      const Vec2 p = g.mean_m() + cholesky_lower(g.covariance_m2()) * Vec2(u, standard_normal(rng));
      if (!scene().world.is_clear(p, 0.25)) continue;
      robots.push_back({RobotId(i), p, false});
      break;
    }
  }
  return robots;
}

TEST(RobotGroups, HoldEveryRobotOnceAndKeepTheRiskLimit) {
  const auto robots = robots_in_flight(200);
  const RiskLimit risk;
  const auto groups = group_robots(robots, scene().world, scene().goal, risk, {});
  ASSERT_TRUE(groups.has_value()) << groups.error().message;

  std::vector<int> seen(200, 0);
  for (const RobotGroup& group : *groups) {
    EXPECT_TRUE(in_free(group.gaussian, scene().world, cvar_coefficient(risk.alpha), risk.delta_m));
    for (const RobotId id : group.members) {
      ++seen[id.value()];
      EXPECT_LT((robots[id.value()].position_m - group.gaussian.mean_m()).norm(), 12.0);
    }
  }
  EXPECT_EQ(seen, std::vector<int>(200, 1));
  EXPECT_LE(groups->size(), 64U);
}

TEST(RobotGroups, DoNotReachThroughWalls) {
  // Two rows of robots on both sides of a thin wall.
  const World world =
      World::make({{0, 0}, {40, 20}},
                  {Polygon::make({{19.9, 2}, {20.1, 2}, {20.1, 18}, {19.9, 18}}).value()})
          .value();
  std::vector<HeardRobot> robots;
  for (std::uint32_t i = 0; i < 10; ++i) {
    robots.push_back({RobotId(i), {i % 2 == 0 ? 18.0 : 22.0, 10.0 + 0.1 * i}, false});
  }
  const Mixture goal = Mixture::make({{1.0, Gaussian::from_parameters({35, 10}, 1, 1, 0)}}).value();

  const auto groups = group_robots(robots, world, goal, {}, {});

  ASSERT_TRUE(groups.has_value());
  ASSERT_EQ(groups->size(), 2U);
  for (const RobotGroup& group : *groups) {
    for (const RobotId id : group.members) EXPECT_EQ(id.value() % 2, group.members[0].value() % 2);
  }
}

TEST(RobotGroups, LetThoseWhoArrivedStay) {
  const Gaussian& home = scene().goal.components()[1].gaussian;
  const std::vector<HeardRobot> robots{{RobotId(0), home.mean_m(), true},
                                       {RobotId(1), home.mean_m() + Vec2(3, 2), true},
                                       {RobotId(2), home.mean_m() + Vec2(1, 1), false}};

  const auto groups = group_robots(robots, scene().world, scene().goal, {}, {});

  ASSERT_TRUE(groups.has_value());
  ASSERT_EQ(groups->size(), 2U);
  EXPECT_EQ(groups->at(0).members.size(), 2U);
  EXPECT_EQ(wasserstein2(groups->at(0).gaussian, home), 0.0);
}

TEST(RobotGroups, SayWhereThereIsNoRoom) {
  // A slot of 0.5 m: half of it is less than k σ + 0.2 m for any σ ≥ 0.1 m.
  const World world =
      World::make({{0, 0}, {10, 10}},
                  {Polygon::make({{0, 0}, {10, 0}, {10, 4.75}, {0, 4.75}}).value(),
                   Polygon::make({{0, 5.25}, {10, 5.25}, {10, 10}, {0, 10}}).value()})
          .value();
  const std::vector<HeardRobot> robots{{RobotId(0), {5, 5}, false}};
  const Mixture goal = Mixture::make({{1.0, Gaussian::from_parameters({9, 5}, 1, 1, 0)}}).value();

  const auto groups = group_robots(robots, world, goal, {}, {});

  ASSERT_FALSE(groups.has_value());
  EXPECT_EQ(groups.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(groups.error().message.find("(5.0, 5.0)"), std::string::npos);
}

TEST(Replan, GivesEveryRobotAnEntryThatMakesTheCountsComeOutRight) {
  const auto robots = robots_in_flight(200);
  Rng rng(3);
  Planner planner({});
  const auto anew = replan(planner, scene().world, scene().goal, robots, 200, rng, &no_time);
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

TEST(Replan, FindsAWayAroundAnObstacleThatWasDropped) {
  const auto robots = robots_in_flight(100);
  std::vector<Obstacle> obstacles = scene().world.obstacles();
  obstacles.push_back(Circle{{100, 50}, 5.0});
  const World world = World::make(scene().world.bounds_m(), obstacles).value();
  Rng rng(4);

  Planner planner({});
  const auto anew = replan(planner, world, scene().goal, robots, 100, rng, &no_time);

  ASSERT_TRUE(anew.has_value()) << anew.error().message;
  EXPECT_LE(planned_max_cvar_m(anew->planned.plan, world, 0.05), -0.2 + 1e-3);
}

TEST(Replan, RefusesAGoalThatWasBuriedAndNamesIt) {
  const auto robots = robots_in_flight(20);
  std::vector<Obstacle> obstacles = scene().world.obstacles();
  obstacles.push_back(Circle{{175, 60}, 5.0});
  const World world = World::make(scene().world.bounds_m(), obstacles).value();
  Rng rng(4);

  Planner planner({});
  const auto anew = replan(planner, world, scene().goal, robots, 20, rng, &no_time);

  ASSERT_FALSE(anew.has_value());
  EXPECT_EQ(anew.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(anew.error().message.find("goal component 1"), std::string::npos)
      << anew.error().message;
}

}  // namespace
}  // namespace swarm::planner
