// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// What the keeper does with scenes and statuses that arrive late, twice or out of order.
#include <algorithm>
#include <cstdint>

#include <gtest/gtest.h>

#include "swarmflow/mission/scene.hpp"
#include "tests/unit/planner_service/keeper_bench.hpp"

namespace swarm::planner {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::KeeperBench;

Scene version(const KeeperBench& bench, std::uint64_t number) {
  Scene scene = bench.scene;
  scene.version = number;
  return scene;
}

TEST(PlanKeeperScene, TakesEachVersionOnceAndNoneThatIsOlder) {
  KeeperBench bench;  // took version 0

  EXPECT_FALSE(bench.keeper.take_scene(version(bench, 0)));
  EXPECT_TRUE(bench.keeper.take_scene(version(bench, 7)));
  EXPECT_FALSE(bench.keeper.take_scene(version(bench, 7)));
  EXPECT_FALSE(bench.keeper.take_scene(version(bench, 6)));
  EXPECT_EQ(bench.keeper.scene().version, 7U);
  EXPECT_TRUE(bench.keeper.take_scene(version(bench, 8)));
}

TEST(PlanKeeperScene, PublishesTheFirstPlanOnceForTheSceneOfTheMission) {
  KeeperBench bench;
  EXPECT_EQ(bench.keeper.version(), 0U);

  EXPECT_TRUE(bench.step_after(milliseconds(50)).publish);
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(bench.step_after(milliseconds(50)).publish);

  EXPECT_EQ(bench.keeper.version(), 1U);
  EXPECT_EQ(bench.keeper.planned_scene(), 0U);
}

TEST(PlanKeeperScene, WaitsThreeSecondsForASceneThatDoesNotCome) {
  const Mission mission = KeeperBench::small_mission();
  PlanKeeper keeper(mission, test::planner_of(mission), 1, &test::no_time);
  ASSERT_TRUE(keeper.plan_first().has_value());
  const SteadyTime begin{seconds(50)};
  const UtcTime utc{seconds(50)};
  keeper.begin(begin);

  EXPECT_FALSE(keeper.step(begin, utc).publish);
  EXPECT_FALSE(keeper.step(begin + milliseconds(2999), utc).publish);
  EXPECT_TRUE(keeper.step(begin + milliseconds(3000), utc).publish);
}

TEST(PlanKeeperScene, PlansOnceForEachChangeAndOnlyWhenItChanges) {
  KeeperBench bench;
  bench.step_after(milliseconds(50));
  const std::uint64_t first = bench.keeper.newest().planned.plan.digest();

  const auto step = bench.step_after(GoTo{.goal = bench.mission.start});

  EXPECT_TRUE(step.publish);
  EXPECT_EQ(bench.keeper.version(), 2U);
  EXPECT_EQ(bench.keeper.planned_scene(), bench.scene.version);
  EXPECT_NE(bench.keeper.newest().planned.plan.digest(), first);
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(bench.step_after(milliseconds(500)).publish);
}

TEST(PlanKeeperScene, KeepsThePlanInForceWhereThereIsNoneForTheScene) {
  KeeperBench bench;
  bench.step_after(milliseconds(50));
  const std::uint64_t first = bench.keeper.newest().planned.plan.digest();
  // A goal on an obstacle of the mission.
  const Obstacle& obstacle = bench.mission.world.obstacles().at(0);
  const Vec2 inside = std::holds_alternative<Circle>(obstacle)
                          ? std::get<Circle>(obstacle).center_m
                          : bench.mission.world.convex_obstacles()[0].box.min_m +
                                0.5 * (bench.mission.world.convex_obstacles()[0].box.max_m -
                                       bench.mission.world.convex_obstacles()[0].box.min_m);
  const GoTo buried{.goal =
                        Mixture::make({{1.0, Gaussian::from_parameters(inside, 1, 1, 0)}}).value()};

  const auto step = bench.step_after(buried);

  EXPECT_FALSE(step.publish);
  ASSERT_EQ(step.notices.size(), 1U);
  EXPECT_TRUE(step.notices[0].warning);
  EXPECT_EQ(step.notices[0].code, "replan-failed");
  EXPECT_EQ(step.notices[0].text.find('\n'), std::string::npos) << "one line";
  EXPECT_EQ(bench.keeper.version(), 1U);
  EXPECT_EQ(bench.keeper.newest().planned.plan.digest(), first);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(bench.step_after(seconds(2)).notices.empty()) << "reported once for a scene";
  }
  EXPECT_TRUE(bench.step_after(GoTo{.goal = bench.mission.goal}).publish) << "and forgotten then";
}

/// An obstacle on a goal, so that there is no plan for the scene.
AddObstacle on_the_goal(const KeeperBench& bench) {
  return {.shape = Circle{bench.mission.goal.components()[0].gaussian.mean_m(), 0.5}};
}

// Robots whose planner was killed wait for a plan of the next one.
TEST(PlanKeeperScene, PublishesTheFirstPlanInFlightWhereThereIsNoneForTheScene) {
  KeeperBench bench;  // of a planner that has just been restarted
  bench.keeper.set_phase(MissionPhase::kRunning);
  bench.robots_version = 3;
  bench.report_all();
  const std::uint64_t first = bench.keeper.newest().planned.plan.digest();

  const auto step = bench.step_after(on_the_goal(bench));

  EXPECT_TRUE(step.publish);
  EXPECT_TRUE(test::has(step.notices, "replan-failed"));
  EXPECT_EQ(bench.keeper.newest().planned.plan.digest(), first);
  EXPECT_EQ(bench.keeper.planned_scene(), 0U);
  bench.run_for(5.0);
  EXPECT_EQ(bench.published, 1) << "once";
  EXPECT_EQ(bench.keeper.version(), 1U);
  bench.robots_version = 1;
  bench.report_all();

  EXPECT_TRUE(bench.step_after(RemoveObstacle{bench.scene.obstacles.at(0).id}).publish);
  EXPECT_EQ(bench.keeper.version(), 4U) << "an earlier planner made the third";
}

// The run directory keeps plans by version: no plan of the planner before may be overwritten.
TEST(PlanKeeperScene, NumbersPlansAfterThoseOfAnEarlierPlanner) {
  for (const std::uint32_t followed : {0U, 1U, 3U}) {
    KeeperBench bench;  // of a planner that has just been restarted
    bench.keeper.set_phase(MissionPhase::kRunning);
    bench.robots_version = followed;
    bench.report_all();

    EXPECT_TRUE(bench.step_after(GoTo{.goal = bench.mission.start}).publish);
    EXPECT_EQ(bench.keeper.version(), std::max(followed, 1U) + 1)
        << "1 is the mission's first plan";
  }
}

// Robots find a restarted planner one after the other.
TEST(PlanKeeperScene, PlansAgainWithRobotsThatReportLate) {
  KeeperBench bench;
  bench.keeper.set_phase(MissionPhase::kRunning);
  for (std::uint32_t robot = 0; robot < 7; ++robot) bench.report(RobotId(robot));
  EXPECT_TRUE(bench.step_after(AddObstacle{.shape = Circle{{1, 1}, 0.2}}).publish);
  EXPECT_FALSE(bench.step_after(seconds(3)).publish) << "nothing new is known";

  bench.report_all();
  EXPECT_TRUE(bench.step_after(milliseconds(50)).publish);

  for (const PlanEntry& entry : bench.keeper.newest().entries) {
    EXPECT_NE(entry.source, PlanEntry::kAnywhere);
  }
  bench.run_for(5.0);
  EXPECT_EQ(bench.published, 2);
}

TEST(PlanKeeperScene, ARestartedPlannerWaitsForRobotsButNotForBodies) {
  KeeperBench bench;
  bench.keeper.set_phase(MissionPhase::kRunning);
  bench.keeper.begin(bench.now);
  bench.scene = after(bench.scene, AddBody{.robot = RobotId(11), .shape = Circle{{1, 1}, 0.2}},
                      bench.mission.world, bench.utc)
                    .value();
  ASSERT_TRUE(bench.keeper.take_scene(bench.scene));
  for (std::uint32_t robot = 0; robot < 10; ++robot) bench.report(RobotId(robot));

  EXPECT_FALSE(bench.step_after(milliseconds(500)).publish) << "robot 10 has not reported";
  bench.report(RobotId(10));
  EXPECT_TRUE(bench.step_after(milliseconds(50)).publish);
}

TEST(PlanKeeperScene, AnAbsurdReportDoesNotUseUpTheNumbers) {
  KeeperBench bench;
  bench.keeper.begin(bench.now);
  bench.keeper.set_phase(MissionPhase::kRunning);
  bench.robots_version = 3;
  bench.report_all();
  for (const std::uint32_t absurd : {10'001U, 4'294'967'295U}) {
    bench.robots_version = absurd;
    bench.report(RobotId(0));
  }

  EXPECT_TRUE(bench.step_after(GoTo{.goal = bench.mission.start}).publish);
  EXPECT_EQ(bench.keeper.version(), 4U);
}

// Robots may have taken a forged plan with a number that a planner as old as this could have.
TEST(PlanKeeperScene, NumbersOnFromWhatItCouldHaveReached) {
  KeeperBench bench;
  bench.keeper.begin(bench.now - seconds(60));
  bench.keeper.set_phase(MissionPhase::kRunning);
  bench.robots_version = 60'000;
  bench.report_all();

  EXPECT_TRUE(bench.step_after(GoTo{.goal = bench.mission.start}).publish);
  EXPECT_EQ(bench.keeper.version(), 60'001U);
}

TEST(PlanKeeperScene, DoesNotLeadRobotsBackToAnEarlierGoal) {
  KeeperBench bench;
  bench.keeper.set_phase(MissionPhase::kRunning);
  bench.robots_version = 3;
  bench.scene =
      after(bench.scene, GoTo{.goal = bench.mission.start}, bench.mission.world, bench.utc).value();
  bench.report_all();
  const Vec2 goal_m = bench.mission.start.components()[0].gaussian.mean_m();

  EXPECT_FALSE(bench.step_after(AddObstacle{.shape = Circle{goal_m, 0.5}}).publish);
}

/// Three robots in flight fell silent; their bodies are cleared again, and the scene is as at
/// first.
class ReturnedRobots : public testing::Test {
 protected:
  ReturnedRobots() {
    bench_.step_after(milliseconds(50));
    bench_.keeper.set_phase(MissionPhase::kRunning);
    bench_.run_for(1.0);
    for (std::uint32_t i = 0; i < 3; ++i) {
      bench_.step_after(AddBody{.robot = RobotId(i), .shape = {bench_.positions_m[i], 0.3}});
    }
  }
  /// The last of the steps.
  PlanKeeper::Step clear_all() {
    PlanKeeper::Step step;
    for (std::uint32_t i = 0; i < 3; ++i) step = bench_.step_after(ClearBody{RobotId(i)});
    return step;
  }
  bool is_planned(std::uint32_t robot) const {
    return bench_.keeper.newest().entries.at(robot).source != PlanEntry::kAnywhere;
  }
  KeeperBench bench_;
};

TEST_F(ReturnedRobots, ArePlannedOnceTheyHaveReported) {
  ASSERT_FALSE(is_planned(0));
  const std::uint32_t before = bench_.keeper.version();

  EXPECT_FALSE(clear_all().publish);
  bench_.report(RobotId(0));
  bench_.report(RobotId(1));
  EXPECT_FALSE(bench_.step_after(milliseconds(500)).publish);
  bench_.report(RobotId(2));
  EXPECT_TRUE(bench_.step_after(milliseconds(50)).publish);

  EXPECT_EQ(bench_.keeper.version(), before + 1);
  for (std::uint32_t i = 0; i < 3; ++i) EXPECT_TRUE(is_planned(i)) << i;
}

TEST_F(ReturnedRobots, AreNotWaitedForLong) {
  clear_all();
  bench_.report(RobotId(1));
  EXPECT_FALSE(bench_.step_after(milliseconds(1000)).publish);
  EXPECT_TRUE(bench_.step_after(milliseconds(500)).publish);

  EXPECT_FALSE(is_planned(0));
  EXPECT_TRUE(is_planned(1));
}

TEST_F(ReturnedRobots, AreNotWaitedForWhenTheyFallSilentAgain) {
  bench_.step_after(ClearBody{RobotId(0)});
  EXPECT_TRUE(bench_.step_after(AddBody{.robot = RobotId(0), .shape = {bench_.positions_m[0], 0.3}})
                  .publish);
}

}  // namespace
}  // namespace swarm::planner
