// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/methods/rover/flow_groups.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "planner_service/groups/robot_groups.hpp"
#include "planner_service/keeper/replan.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "swarm_core/mission/placement.hpp"
#include "swarm_core/plan/flow_draw.hpp"
#include "swarmflow/core/random.hpp"
#include "tests/unit/planner_service/methods/rover/rover_scene.hpp"

namespace swarm::planner {
namespace {

Gaussian disc(double x, double y, double sigma) {
  return Gaussian::from_parameters({x, y}, sigma, sigma, 0.0);
}

struct Scene2 {
  Mission mission = test::rover_scene(2);
  RiskGraph graph = RiskGraph::make(mission.world, mission.goal, {}).value();
};

const Scene2& scene() {
  static const Scene2 s;
  return s;
}

std::vector<RobotGroup> grouped(const std::vector<ReportedRobot>& robots) {
  return group_by_flow(robots, scene().graph, scene().mission.goal, {});
}

/// `count` robots around a position, on a leg.
void add(std::vector<ReportedRobot>& robots, const Vec2& mean_m, double sigma_m,
         std::uint32_t count, std::optional<std::uint32_t> leg, Rng& rng) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const double x = standard_normal(rng);
    robots.push_back({.robot = RobotId(static_cast<std::uint32_t>(robots.size())),
                      .position_m = mean_m + sigma_m * Vec2(x, standard_normal(rng)),
                      .leg = leg});
  }
}

std::vector<std::uint32_t> sorted_ids(const RobotGroup& group) {
  std::vector<std::uint32_t> ids;
  for (const RobotId id : group.members) ids.push_back(id.value());
  std::sort(ids.begin(), ids.end());
  return ids;
}

TEST(FlowGroups, AreTheRobotsOfALegWithTheirOwnMoments) {
  Rng rng(1);
  std::vector<ReportedRobot> robots;
  add(robots, {25, 40}, 4.0, 50, 3, rng);
  add(robots, {25, 70}, 4.0, 30, 8, rng);

  const auto groups = grouped(robots);

  ASSERT_EQ(groups.size(), 2U);
  ASSERT_EQ(groups[0].members.size(), 50U);
  Vec2 mean = Vec2::Zero();
  Mat2 square = Mat2::Zero();
  for (std::size_t i = 0; i < 50; ++i) {
    mean += robots[i].position_m / 50.0;
    square += robots[i].position_m * robots[i].position_m.transpose() / 50.0;
  }
  EXPECT_LT((groups[0].gaussian.mean_m() - mean).norm(), 1e-9);
  const Mat2 covariance = square - mean * mean.transpose() + 0.25 * Mat2::Identity();
  EXPECT_LT((groups[0].gaussian.covariance_m2() - covariance).norm(), 1e-6);
}

TEST(FlowGroups, JoinNearGroupsAndDivideWideOnes) {
  Rng rng(2);
  std::vector<ReportedRobot> robots;
  add(robots, {25, 40}, 3.0, 60, 1, rng);
  add(robots, {25.5, 40.5}, 3.0, 60, 2, rng);
  add(robots, {25, 100}, 14.0, 80, 5, rng);

  const auto groups = grouped(robots);

  EXPECT_EQ(groups[0].members.size(), 120U);
  EXPECT_GE(groups.size(), 3U);
  std::vector<int> seen(robots.size(), 0);
  for (const RobotGroup& group : groups) {
    EXPECT_LE(group.gaussian.max_sigma_m(), 8.0);
    for (const RobotId id : group.members) ++seen[id.value()];
  }
  EXPECT_EQ(seen, std::vector<int>(robots.size(), 1));
}

TEST(FlowGroups, HaveNoMeanInAnObstacle) {
  // Robots on both sides of the first polygon, which the mean of all lies in.
  std::vector<ReportedRobot> robots;
  for (std::uint32_t i = 0; i < 40; ++i) {
    robots.push_back(
        {.robot = RobotId(i), .position_m = {i % 2 == 0 ? 44.0 : 96.0, 30.0 + 0.2 * i}, .leg = 0});
  }
  for (const RobotGroup& group : grouped(robots)) {
    EXPECT_TRUE(scene().mission.world.is_clear(group.gaussian.mean_m(), 0.3));
  }
}

TEST(FlowGroups, LetArrivedRobotsStayAtTheGoalTheyWereAssigned) {
  // Between two goals that overlap: nearer to the first, led to the second.
  const Vec2 between{175, 49};
  const std::vector<ReportedRobot> robots{
      {.robot = RobotId(0), .position_m = between, .arrived = true, .goal = 1},
      {.robot = RobotId(1),
       .position_m = between + Vec2(1, 0),
       .arrived = false,
       .leg = 4,
       .goal = 1}};

  const auto groups = grouped(robots);

  ASSERT_EQ(groups.size(), 2U);
  EXPECT_EQ(sorted_ids(groups[0]), std::vector<std::uint32_t>{0});
  EXPECT_EQ(wasserstein2(groups[0].gaussian, scene().mission.goal.components()[1].gaussian), 0.0);
}

TEST(FlowGroups, TakeInRobotsWithoutALeg) {
  Rng rng(3);
  std::vector<ReportedRobot> robots;
  add(robots, {25, 40}, 6.0, 100, std::nullopt, rng);
  std::size_t members = 0;
  for (const RobotGroup& group : grouped(robots)) members += group.members.size();
  EXPECT_EQ(members, 100U);
}

TEST(GoalInRobots, GivesWholeRobotsAndKeepsThoseWhoAreLed) {
  const Mixture& goal = scene().mission.goal;  // 0.25, 0.375, 0.375
  const auto robots_of = [&](std::array<std::size_t, 3> led, std::size_t count) {
    std::array<double, 3> robots{};
    const Mixture whole = goal_in_robots(goal, led, count, scene().mission.world, {0.3, -0.2});
    for (std::size_t j = 0; j < 3; ++j) {
      robots[j] = whole.components()[j].weight * static_cast<double>(count);
    }
    return robots;
  };
  const std::array<std::array<std::size_t, 3>, 3> led{
      {{125, 188, 187}, {125, 187, 188}, {0, 0, 0}}};
  for (const auto& before : led) {
    const auto robots = robots_of(before, 500);
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_NEAR(robots[j], std::round(robots[j]), 1e-9);
      EXPECT_LT(std::abs(robots[j] - 500.0 * goal.components()[j].weight), 1.0);
      if (before[0] == 0) continue;
      EXPECT_NEAR(robots[j], static_cast<double>(before[j]), 1e-9);
    }
    EXPECT_NEAR(robots[0] + robots[1] + robots[2], 500.0, 1e-9);
  }
}

/// A source with two routes, whose second begins with a longer leg.
FlowPlan fork() {
  std::vector<PlanNode> nodes{{disc(0, 0, 3), MissionTime(0), 1.0},
                              {disc(20, 8, 5), MissionTime(18), 0.5},
                              {disc(20, -8, 5), MissionTime(18), 0.5}};
  return FlowPlan::make(std::move(nodes), {{0, 1, 0.5}, {0, 2, 0.5}}).value();
}

/// The sink each member of a source is drawn to.
std::vector<std::uint32_t> sinks_of(const FlowPlan& plan, const RobotGroup& group) {
  std::vector<std::uint32_t> sinks(group.members.size());
  for (std::uint32_t rank = 0; rank < group.members.size(); ++rank) {
    const auto size = static_cast<std::uint32_t>(group.members.size());
    const double share = PlanEntry::share_of(stratified_share(rank, size)) / 65536.0;
    sinks[group.members[rank].value()] = position_in_flow(plan, 0, share, MissionTime(0)).sink;
  }
  return sinks;
}

double cost_of(const FlowPlan& plan, const std::vector<ReportedRobot>& robots, const Mixture& goal,
               const std::vector<std::uint32_t>& sinks) {
  double cost = 0.0;
  const Gaussian& from = plan.nodes()[0].gaussian;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const Gaussian& to = plan.nodes()[sinks[i]].gaussian;
    const Vec2 end = to.mean_m() + transport_map(from, to) * (robots[i].position_m - from.mean_m());
    cost += (end - robots[i].position_m).squaredNorm();
    const auto component = component_at(goal, to.mean_m());
    if (robots[i].goal && component != robots[i].goal) cost += kOtherGoal_m2;
  }
  return cost;
}

TEST(OrderByFlow, IsTheCheapestOfAllAssignments) {
  const FlowPlan plan = fork();
  const Mixture goal = Mixture::make({{0.5, disc(20, 8, 5)}, {0.5, disc(20, -8, 5)}}).value();
  Rng rng(5);
  for (int round = 0; round < 20; ++round) {
    std::vector<ReportedRobot> robots;
    RobotGroup group{disc(0, 0, 3), {}};
    for (std::uint32_t i = 0; i < 7; ++i) {
      const double x = 3.0 * standard_normal(rng);
      robots.push_back({.robot = RobotId(i),
                        .position_m = {x, 3.0 * standard_normal(rng)},
                        .goal = i % 3 == 0 ? std::nullopt : std::optional(i % 2)});
      group.members.push_back(RobotId(i));
    }
    std::vector<RobotGroup> groups{group};
    order_by_flow(groups, plan, goal, robots);
    const auto sinks = sinks_of(plan, groups[0]);

    std::vector<std::uint32_t> any = sinks;
    std::sort(any.begin(), any.end());
    double least = std::numeric_limits<double>::infinity();
    do {
      least = std::min(least, cost_of(plan, robots, goal, any));
    } while (std::next_permutation(any.begin(), any.end()));
    EXPECT_NEAR(cost_of(plan, robots, goal, sinks), least, 1e-6 * least);
    EXPECT_LE(std::abs(static_cast<double>(std::count(sinks.begin(), sinks.end(), 1U)) - 3.5), 0.5);
  }
}

}  // namespace
}  // namespace swarm::planner
