// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// ROVER in the loop: a plan each second from the positions of the robots.
#include <algorithm>
#include <optional>

#include <gtest/gtest.h>

#include "planner_service/groups/robot_groups.hpp"
#include "planner_service/keeper/plan_keeper.hpp"
#include "planner_service/methods/rover/flow_groups.hpp"
#include "planner_service/methods/rover/plan_excess.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "swarm_core/mission/placement.hpp"
#include "swarm_core/plan/flow_draw.hpp"
#include "swarm_core/risk/mixture_cvar.hpp"
#include "tests/unit/planner_service/keeper_bench.hpp"
#include "tests/unit/planner_service/methods/rover/rover_scene.hpp"

namespace swarm::planner {
namespace {

using std::chrono::milliseconds;

using test::has;

/// A keeper, and robots that follow its plans exactly.
struct Bench {
  Mission mission = test::rover_scene(2);
  std::optional<PlanKeeper> keeper;
  SteadyTime now{std::chrono::seconds(100)};
  UtcTime utc{std::chrono::seconds(100)};
  std::vector<ReportedRobot> robots;

  explicit Bench(std::uint32_t count = 60) {
    mission.robots.count = count;
    const std::vector<Vec2> positions_m = place_robots(mission, 1).value();
    for (std::uint32_t i = 0; i < count; ++i) {
      robots.push_back({.robot = RobotId(i), .position_m = positions_m[i]});
    }
    start_planner();
  }
  void start_planner() {
    keeper.emplace(mission, test::planner_of(mission), 1, &test::no_time);
    EXPECT_TRUE(keeper->plan_first().has_value());
    keeper->begin(now);
    keeper->take_scene(first_scene(mission.world.obstacles().size()));
  }
  void report() {
    for (const ReportedRobot& robot : robots) keeper->receive(robot, !robot.arrived, now);
  }
  PlanKeeper::Step step_after(milliseconds time) {
    now += time;
    utc += time;
    return keeper->step(now, utc);
  }
  FlowPosition place_of(const ReportedRobot& robot) const {
    const Replan& newest = keeper->newest();
    const FlowPlan& plan = newest.planned.plan;
    double share = stratified_share(robot.robot.value(), mission.robots.count);
    if (newest.entries.empty()) {
      const std::size_t source = draw_source(plan, share);
      return position_in_flow(plan, source, share, MissionTime(0));
    }
    const PlanEntry& entry = newest.entries[robot.robot.value()];
    return position_in_flow(plan, entry.source, entry.share / 65536.0, MissionTime(0));
  }
  /// Moves each robot along its first leg for a second.
  void move() {
    const FlowPlan& plan = keeper->newest().planned.plan;
    for (ReportedRobot& robot : robots) {
      robot.plan_version = keeper->version();
      const FlowPosition place = place_of(robot);
      if (robot.arrived || place.leg == FlowPosition::kAtSink) continue;
      const PlanLeg& leg = plan.legs()[place.leg];
      const Gaussian& from = plan.nodes()[leg.from].gaussian;
      const Gaussian& to = plan.nodes()[leg.to].gaussian;
      const Vec2 end_m = to.mean_m() + transport_map(from, to) * (robot.position_m - from.mean_m());
      const double share = std::min(1.0, 1.0 / plan.nodes()[leg.to].time.count());
      robot.position_m += share * (end_m - robot.position_m);
      const bool is_last = leg.to == place.sink;
      robot.arrived = is_last && (end_m - robot.position_m).norm() < 1.0;
    }
  }
  void fly(int seconds) {
    for (int s = 0; s < seconds; ++s) {
      move();
      report();
      step_after(milliseconds(1000));
    }
  }
};

TEST(RoverSteps, APlanEachSecondFromTheRobotPositions) {
  Bench bench;
  EXPECT_TRUE(bench.step_after(milliseconds(50)).publish);
  bench.report();
  EXPECT_FALSE(bench.step_after(milliseconds(2000)).publish) << "not before the mission runs";
  bench.keeper->set_phase(MissionPhase::kRunning);
  bench.report();
  EXPECT_TRUE(bench.step_after(milliseconds(50)).publish);
  EXPECT_FALSE(bench.step_after(milliseconds(900)).publish);
  EXPECT_TRUE(bench.step_after(milliseconds(100)).publish);
  EXPECT_EQ(bench.keeper->version(), 3U);
  EXPECT_EQ(bench.keeper->clock(bench.utc).plan_time_s, 0.0);

  // The plan begins with the robots' own mean and spread.
  const Mixture start = bench.keeper->newest().planned.plan.mixture_at(MissionTime(0));
  Vec2 planned_m = Vec2::Zero();
  Vec2 measured_m = Vec2::Zero();
  for (const auto& [weight, gaussian] : start.components()) planned_m += weight * gaussian.mean_m();
  for (const ReportedRobot& robot : bench.robots) measured_m += robot.position_m / 60.0;
  EXPECT_LT((planned_m - measured_m).norm(), 1e-6);
}

TEST(RoverSteps, KeepRobotsUnderWay) {
  Bench bench;
  bench.step_after(milliseconds(50));
  bench.keeper->set_phase(MissionPhase::kRunning);
  const auto goal_of = [&](const ReportedRobot& robot) {
    const FlowPlan& plan = bench.keeper->newest().planned.plan;
    return component_at(bench.mission.goal,
                        plan.nodes()[bench.place_of(robot).sink].gaussian.mean_m());
  };
  int changes = 0;
  std::vector<std::optional<std::uint32_t>> goals(60);
  std::vector<Vec2> begin_m;
  for (const ReportedRobot& robot : bench.robots) begin_m.push_back(robot.position_m);
  double path_m = 0.0;
  for (int s = 0; s < 60; ++s) {
    std::vector<Vec2> before_m;
    for (const ReportedRobot& robot : bench.robots) before_m.push_back(robot.position_m);
    bench.fly(1);
    for (std::size_t i = 0; i < 60; ++i) {
      path_m += (bench.robots[i].position_m - before_m[i]).norm();
      const auto goal = goal_of(bench.robots[i]);
      changes += s > 0 && goal != goals[i] ? 1 : 0;
      goals[i] = goal;
    }
  }
  double distance_m = 0.0;
  for (std::size_t i = 0; i < 60; ++i)
    distance_m += (bench.robots[i].position_m - begin_m[i]).norm();
  // Without a memory of goals each robot changes its own about every third plan; with one less than
  // half as often: which goal is nearer is not decided while several are far.
  EXPECT_LE(changes, 60 * 59 / 6);
  EXPECT_LE(path_m, 1.15 * distance_m);
  EXPECT_GE(distance_m, 60.0 * 40.0);
}

TEST(RoverSteps, GoOnUntilTheLastRobotHasArrived) {
  Bench bench;
  bench.step_after(milliseconds(50));
  bench.keeper->set_phase(MissionPhase::kRunning);
  bench.report();
  bench.step_after(milliseconds(50));
  for (ReportedRobot& robot : bench.robots) {
    const FlowPosition place = bench.place_of(robot);
    robot.position_m = bench.keeper->newest().planned.plan.nodes()[place.sink].gaussian.mean_m();
    robot.arrived = robot.robot != RobotId(7);
  }
  bench.robots[7].position_m += Vec2(-15, 0);
  bench.report();
  EXPECT_TRUE(bench.step_after(milliseconds(1000)).publish);
  bench.robots[7].arrived = true;
  bench.report();
  EXPECT_FALSE(bench.step_after(milliseconds(1000)).publish);
}

TEST(RoverSteps, CountTheLagOfRobotsAFewPlansBehind) {
  Bench bench;
  bench.step_after(milliseconds(50));
  bench.keeper->set_phase(MissionPhase::kRunning);
  bench.fly(6);
  for (ReportedRobot& robot : bench.robots) robot.lag_s = 20.0;
  const auto rate_of_plans_back = [&](std::uint32_t back) {
    for (int s = 0; s < 2; ++s) {
      for (ReportedRobot& robot : bench.robots) robot.plan_version = bench.keeper->version() - back;
      bench.report();
      bench.step_after(milliseconds(1000));
    }
    return bench.keeper->clock(bench.utc).rate;
  };
  EXPECT_LT(rate_of_plans_back(1), 1.0);
  EXPECT_EQ(rate_of_plans_back(5), 1.0);
}

TEST(RoverSteps, ARestartedPlannerPlansFromTheRobotPositions) {
  Bench bench;
  bench.step_after(milliseconds(50));
  bench.keeper->set_phase(MissionPhase::kRunning);
  bench.fly(30);
  for (ReportedRobot& robot : bench.robots) robot.plan_version = bench.keeper->version();
  bench.start_planner();
  bench.keeper->set_phase(MissionPhase::kRunning);

  EXPECT_FALSE(bench.step_after(milliseconds(50)).publish) << "before it received the robots";
  bench.report();
  EXPECT_TRUE(bench.step_after(milliseconds(50)).publish);
  const Replan& newest = bench.keeper->newest();
  ASSERT_EQ(newest.entries.size(), 60U);
  for (const ReportedRobot& robot : bench.robots) {
    const FlowPlan& plan = newest.planned.plan;
    const PlanEntry& entry = newest.entries[robot.robot.value()];
    const Gaussian& source = plan.nodes()[plan.sources()[entry.source]].gaussian;
    EXPECT_LE(source.mahalanobis_squared(robot.position_m), 25.0);
  }
}

TEST(RoverSteps, ReportByHowMuchAPlanBreaksTheLimit) {
  Bench bench;
  bench.step_after(milliseconds(50));
  EXPECT_EQ(bench.keeper->newest().planned.excess.by_m, 0.0);
  bench.keeper->set_phase(MissionPhase::kRunning);
  // A tenth of the robots is at rest with its mean 1 m beside the first obstacle, spread along it.
  for (std::size_t i = 0; i < 6; ++i) {
    bench.robots[i].position_m = {50.0 - 2.0, 60.0 + static_cast<double>(i)};
  }
  bench.report();
  const PlanKeeper::Step step = bench.step_after(milliseconds(1000));
  ASSERT_TRUE(step.publish);
  const PlanResult& planned = bench.keeper->newest().planned;
  const double at_start_m =
      max_mixture_cvar_m(planned.plan.mixture_at(MissionTime(0)), bench.mission.world, 0.05) + 0.2;
  EXPECT_EQ(has(step.notices, "plan-excess"), planned.excess.by_m > 0.0);
  EXPECT_GE(planned.excess.by_m, std::max(0.0, at_start_m) - 1e-9);
}

TEST(PlanExcess, IsTheLargestOverTheCheckedTimes) {
  const World world = World::make({{0, 0}, {100, 50}},
                                  {Polygon::make({{45, 20}, {55, 20}, {55, 30}, {45, 30}}).value()})
                          .value();
  const auto disc = [](double x) { return Gaussian::from_parameters({x, 25}, 2, 2, 0.0); };
  // Straight through the obstacle: its middle is half of the leg.
  const FlowPlan through =
      FlowPlan::make({{disc(20), MissionTime(0), 1.0}, {disc(80), MissionTime(48), 1.0}},
                     {{0, 1, 1.0}})
          .value();
  const RiskLimit risk{.alpha = 0.05, .delta_m = -0.2};

  EXPECT_EQ(excess_of(through, world, risk, 0).by_m, 0.0);
  const PlanExcess excess = excess_of(through, world, risk, 1);
  EXPECT_NEAR(excess.by_m,
              max_mixture_cvar_m(through.mixture_at(MissionTime(24)), world, 0.05) + 0.2, 1e-9);
  EXPECT_GT(excess.by_m, 4.0);
  EXPECT_DOUBLE_EQ(excess.at.count(), 24.0);
  EXPECT_NE(describe(excess).find("obstacle 0"), std::string::npos);
}

}  // namespace
}  // namespace swarm::planner
