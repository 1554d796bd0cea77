// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The bodies of failed robots in the planner's scene.
#include <gtest/gtest.h>

#include "swarmflow/core/cvar.hpp"
#include "tests/unit/planner_service/keeper_bench.hpp"

namespace swarm::planner {
namespace {

using test::has;

/// Robots in flight.
struct Bench : test::KeeperBench {
  Bench() {
    step_after(std::chrono::milliseconds(50));
    keeper.set_phase(MissionPhase::kRunning);
    report_all();
  }
};

TEST(PlannedBodies, AreRoutedAround) {
  Bench bench;
  // Between the wall and the block, where the first plan leads.
  const PlanKeeper::Step step = bench.step_after(AddBody{RobotId(3), {{20, 14.5}, 0.2}});

  EXPECT_TRUE(step.publish);
  EXPECT_FALSE(has(step.notices, "bodies-not-planned"));
  const World with_body = world_at(bench.mission.world, bench.scene, bench.utc);
  const FlowPlan& plan = bench.keeper.newest().planned.plan;
  const double k = cvar_coefficient(bench.mission.planner.risk_alpha);
  for (double t = 0.0; t <= plan.duration().count(); t += 0.5) {
    const Mixture mixture = plan.mixture_at(MissionTime(t));
    for (const auto& [weight, gaussian] : mixture.components()) {
      EXPECT_LE(max_cvar_m(gaussian, with_body, k), bench.mission.planner.risk_delta_m + 1e-9) << t;
    }
  }
}

TEST(PlannedBodies, AreLeftToTheRobotsWhereNoPlanGetsAroundThem) {
  Bench bench;
  const Vec2 goal_m = bench.mission.goal.components()[0].gaussian.mean_m();

  const PlanKeeper::Step step = bench.step_after(AddBody{RobotId(3), {goal_m, 0.2}});

  EXPECT_TRUE(step.publish) << "there is a plan all the same";
  EXPECT_TRUE(has(step.notices, "bodies-not-planned"));
  EXPECT_FALSE(has(step.notices, "replan-failed"));
  EXPECT_EQ(bench.keeper.planned_scene(), bench.scene.version);
}

TEST(PlannedBodies, DoNotHideAnObstacleThatBlocks) {
  Bench bench;
  bench.step_after(AddBody{RobotId(3), {{20, 14.5}, 0.2}});
  const Vec2 goal_m = bench.mission.goal.components()[0].gaussian.mean_m();

  const PlanKeeper::Step step = bench.step_after(AddObstacle{Circle{goal_m, 0.3}});

  EXPECT_FALSE(step.publish);
  EXPECT_TRUE(has(step.notices, "replan-failed"));
}

TEST(PlannedBodies, CarryNoMass) {
  Bench bench;
  bench.report(RobotId(3));
  const PlanKeeper::Step step = bench.step_after(AddBody{RobotId(3), {{20, 14.5}, 0.2}});
  ASSERT_TRUE(step.publish);
  const auto entry = [&] { return bench.keeper.newest().entries.at(3).source; };
  EXPECT_EQ(entry(), PlanEntry::kAnywhere) << "it is in no group";

  bench.report(RobotId(3));  // sent before it failed
  bench.step_after(SetRisk{0.06});
  EXPECT_EQ(entry(), PlanEntry::kAnywhere);

  bench.step_after(ClearBody{RobotId(3)});
  bench.report(RobotId(3));
  bench.step_after(SetRisk{0.07});
  EXPECT_NE(entry(), PlanEntry::kAnywhere);
}

}  // namespace
}  // namespace swarm::planner
