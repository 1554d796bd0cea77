// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "planner_service/keeper/plan_keeper.hpp"
#include "swarm_core/mission/placement.hpp"
#include "swarmflow/mission/mission_file.hpp"
#include "tests/unit/planner_service/planners.hpp"

namespace swarm::test {

inline bool has(const std::vector<planner::PlanKeeper::Notice>& notices, const std::string& code) {
  return std::any_of(notices.begin(), notices.end(),
                     [&](const auto& notice) { return notice.code == code; });
}

/// A keeper whose robots stay where they were placed, and the time. It joined the bus long ago, so
/// it does not wait for robots that have not reported yet.
class KeeperBench {
 public:
  static Mission small_mission() {
    const std::filesystem::path source(SWARM_SOURCE_DIR);
    return load_mission(source / "deploy/missions/small.yaml").value();
  }

  KeeperBench() : KeeperBench(small_mission(), planner_of(small_mission())) {}
  KeeperBench(Mission of, planner::Planner planner)
      : mission(std::move(of)),
        keeper(mission, std::move(planner), 1, &no_time),
        scene(first_scene(mission.world.obstacles().size())),
        positions_m(place_robots(mission, 1).value()) {
    EXPECT_TRUE(keeper.plan_first().has_value());
    keeper.begin(now - std::chrono::seconds(10));
    keeper.take_scene(scene);
  }

  void report(RobotId robot) {
    keeper.receive({.robot = robot,
                    .position_m = positions_m[robot.value()],
                    .lag_s = lag_s,
                    .plan_version = robots_version,
                    .plan_time_s = robots_plan_time_s},
                   true, now);
  }
  void report_all() {
    for (std::uint32_t i = 0; i < positions_m.size(); ++i) report(RobotId(i));
  }

  planner::PlanKeeper::Step step_after(Duration time) {
    now += time;
    utc += time;
    planner::PlanKeeper::Step step = keeper.step(now, utc);
    if (step.clock) readings.push_back(*step.clock);
    notices.insert(notices.end(), step.notices.begin(), step.notices.end());
    if (step.publish) ++published;
    return step;
  }
  planner::PlanKeeper::Step step_after(const SceneChange& change) {
    scene = after(scene, change, mission.world, utc).value();
    EXPECT_TRUE(keeper.take_scene(scene));
    return step_after(std::chrono::milliseconds(50));
  }
  /// Ten steps a second, before each of which all robots report.
  void run_for(double time_s) {
    for (int i = 0; i < static_cast<int>(time_s * 10.0 + 0.5); ++i) {
      now += std::chrono::milliseconds(100);
      utc += std::chrono::milliseconds(100);
      report_all();
      step_after(Duration(0));
    }
  }

  Mission mission;
  planner::PlanKeeper keeper;
  Scene scene;
  SteadyTime now{std::chrono::seconds(100)};
  UtcTime utc{std::chrono::seconds(100)};
  std::vector<Vec2> positions_m;
  // Values that robots report besides their positions.
  double lag_s = 0.0;
  double robots_plan_time_s = 0.0;
  std::uint32_t robots_version = 1;
  // Results of all steps so far.
  std::vector<PlanClock> readings;
  std::vector<planner::PlanKeeper::Notice> notices;
  int published = 0;
};

}  // namespace swarm::test
