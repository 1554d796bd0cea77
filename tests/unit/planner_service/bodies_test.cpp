// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The bodies of fallen robots in the planner's scene.
#include <algorithm>
#include <optional>

#include <gtest/gtest.h>

#include "planner_service/plan_keeper.hpp"
#include "swarm_core/mission/mission_file.hpp"
#include "swarm_core/mission/placement.hpp"
#include "swarm_core/risk/cvar.hpp"

namespace swarm::planner {
namespace {

SteadyTime no_time() { return {}; }

/// A keeper in flight, whose robots all are where they were placed.
struct Bench {
  Mission mission;
  std::optional<PlanKeeper> keeper;
  Scene scene;
  SteadyTime now{std::chrono::seconds(100)};
  UtcTime utc{std::chrono::seconds(100)};
  std::vector<Vec2> positions_m;

  Bench()
      : mission(load_mission(std::filesystem::path(SWARM_SOURCE_DIR) / "deploy/missions/small.yaml")
                    .value()),
        scene(first_scene(mission.world.obstacles().size())),
        positions_m(place_robots(mission, 1).value()) {
    keeper.emplace(mission, 1, &no_time);
    EXPECT_TRUE(keeper->plan_first().has_value());
    // Long ago: a planner that has just joined waits for the statuses of robots it has none of.
    keeper->begin(now - std::chrono::seconds(10));
    keeper->take_scene(scene);
    step();
    keeper->set_phase(MissionPhase::kRunning);
    for (std::uint32_t i = 0; i < positions_m.size(); ++i) report(RobotId(i));
  }
  void report(RobotId robot) {
    keeper->hear({.robot = robot, .position_m = positions_m[robot.value()], .arrived = false}, true,
                 now);
  }
  PlanKeeper::Step step() {
    now += std::chrono::milliseconds(50);
    utc += std::chrono::milliseconds(50);
    return keeper->step(now, utc);
  }
  PlanKeeper::Step step_after(const SceneChange& change) {
    scene = after(scene, change, mission.world, utc).value();
    EXPECT_TRUE(keeper->take_scene(scene));
    return step();
  }
};

bool has(const PlanKeeper::Step& step, const std::string& code) {
  return std::any_of(step.notices.begin(), step.notices.end(),
                     [&](const PlanKeeper::Notice& notice) { return notice.code == code; });
}

TEST(PlannedBodies, AreRoutedAround) {
  Bench bench;
  // Between the wall and the block, where the first plan leads.
  const PlanKeeper::Step step = bench.step_after(AddBody{RobotId(3), {{20, 14.5}, 0.2}});

  EXPECT_TRUE(step.publish);
  EXPECT_FALSE(has(step, "bodies-not-planned"));
  const World with_body = world_at(bench.mission.world, bench.scene, bench.utc);
  const FlowPlan& plan = bench.keeper->newest().planned.plan;
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
  EXPECT_TRUE(has(step, "bodies-not-planned"));
  EXPECT_FALSE(has(step, "replan-failed"));
  EXPECT_EQ(bench.keeper->planned_scene(), bench.scene.version);
}

TEST(PlannedBodies, DoNotHideAnObstacleThatBlocks) {
  Bench bench;
  bench.step_after(AddBody{RobotId(3), {{20, 14.5}, 0.2}});
  const Vec2 goal_m = bench.mission.goal.components()[0].gaussian.mean_m();

  const PlanKeeper::Step step = bench.step_after(AddObstacle{Circle{goal_m, 0.3}});

  EXPECT_FALSE(step.publish);
  EXPECT_TRUE(has(step, "replan-failed"));
}

TEST(PlannedBodies, CarryNoMass) {
  Bench bench;
  bench.report(RobotId(3));
  const PlanKeeper::Step step = bench.step_after(AddBody{RobotId(3), {{20, 14.5}, 0.2}});
  ASSERT_TRUE(step.publish);
  const auto entry = [&] { return bench.keeper->newest().entries.at(3).source; };
  EXPECT_EQ(entry(), PlanEntry::kAnywhere) << "it is in no group";

  bench.report(RobotId(3));  // sent before it fell
  bench.step_after(SetRisk{0.06});
  EXPECT_EQ(entry(), PlanEntry::kAnywhere);

  bench.step_after(ClearBody{RobotId(3)});
  bench.report(RobotId(3));
  bench.step_after(SetRisk{0.07});
  EXPECT_NE(entry(), PlanEntry::kAnywhere);
}

}  // namespace
}  // namespace swarm::planner
