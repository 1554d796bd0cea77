// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/audit.hpp"

#include <fstream>
#include <memory>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "swarm_core/robot_log/robot_log_file.hpp"
#include "swarmflow/core/shape_field.hpp"
#include "tests/unit/swarm_monitor/synthetic_run.hpp"

namespace swarm::monitor {
namespace {

Audit audit_of(const SyntheticRun& files) {
  auto audit = audit_run(files.dir());
  EXPECT_TRUE(audit.has_value()) << audit.error().message;
  return audit.value_or(Audit{});
}

TEST(Audit, PassesAGoodRun) {
  SyntheticRun files(8);
  files.write_good_run();

  const Audit audit = audit_of(files);

  EXPECT_TRUE(audit.ok()) << audit.reasons[0];
  EXPECT_EQ(audit.robots, 8U);
  EXPECT_EQ(audit.processes, 8U);
  EXPECT_EQ(audit.arrived, 8U);
  EXPECT_EQ(audit.arrived_per_goal, (std::vector<std::uint32_t>{4, 4}));
  EXPECT_EQ(audit.collisions_robot, 0U);
  EXPECT_EQ(audit.collisions_obstacle, 0U);
  EXPECT_EQ(audit.outside_bounds, 0U);
  EXPECT_EQ(audit.deadline_miss_ratio, 0.0);
  // At the end neighbours are 0.6 m apart, centre to centre.
  ASSERT_TRUE(audit.min_robot_gap_m.has_value());
  EXPECT_NEAR(*audit.min_robot_gap_m, 0.2, 1e-9);
  // Straight lines in the order of the start: no assignment is shorter.
  ASSERT_TRUE(audit.path_ratio.has_value());
  EXPECT_NEAR(*audit.path_ratio, 1.0, 1e-6);
  ASSERT_TRUE(audit.mission_s.has_value());
  EXPECT_NEAR(*audit.mission_s, 20.0, 1e-6);
  ASSERT_TRUE(audit.state_age.has_value());
  EXPECT_NEAR(audit.state_age->max_ms, 30.0, 30.0 / 16);
  EXPECT_FALSE(audit.plan_ms.has_value());
}

TEST(Audit, CallsARobotWithoutAnExitLost) {
  SyntheticRun files(8);
  files.write_good_run();
  std::filesystem::remove(robot_log::file_of(files.dir(), RobotId(3)));
  std::filesystem::remove(robot_log::file_of(files.dir(), RobotId(5)));
  files.write(5, {.positions_m = straight({6, 13}, {29, 15}, 100), .goal = 1, .graceful = false});

  const Audit audit = audit_of(files);

  EXPECT_FALSE(audit.ok());
  EXPECT_EQ(audit.lost, (std::vector<RobotId>{RobotId(3), RobotId(5)}));
  EXPECT_EQ(audit.arrived, 6U);
  EXPECT_EQ(audit.reasons[0], "2 lost: robot 3, 5");
}

TEST(Audit, DoesNotCallARespawnedRobotLost) {
  SyntheticRun files(2);
  files.write(0, {.positions_m = straight({5, 5}, {10, 5}, 50), .graceful = false});
  files.write(0, {.positions_m = straight({10, 5}, {30, 5}, 200), .begin_s = 6.0});
  files.write(1, {.positions_m = straight({5, 15}, {30, 15}, 200), .goal = 1});

  const Audit audit = audit_of(files);

  EXPECT_TRUE(audit.ok()) << audit.reasons[0];
  EXPECT_EQ(audit.processes, 1U);
}

TEST(Audit, WantsTheLastPositionInsideTheGoalsEllipse) {
  SyntheticRun files(2);
  // 99 % of N((30, 5), I): radius 3.0349.
  files.write(0, {.positions_m = straight({5, 5}, {33.03, 5}, 100)});
  files.write(1, {.positions_m = straight({5, 15}, {33.04, 15}, 100), .goal = 1});

  const Audit audit = audit_of(files);

  EXPECT_EQ(audit.arrived_per_goal, (std::vector<std::uint32_t>{1, 0}));
  EXPECT_EQ(audit.reasons, (std::vector<std::string>{"1 not arrived: robot 1"}));
}

TEST(Audit, DoesNotTrustTheModeArrived) {
  SyntheticRun files(1);
  files.write(0, {.positions_m = straight({5, 5}, {12, 5}, 100)});

  EXPECT_EQ(audit_of(files).arrived, 0U);
}

TEST(Audit, FindsContactsBetweenTheTicks) {
  SyntheticRun files(2);
  // Crossing at right angles through the same point at the same time, in one step of 2 m.
  files.write(0, {.positions_m = straight({1, 5}, {29, 5}, 14)});
  files.write(1, {.positions_m = straight({8, 12}, {8, -2}, 7), .goal = 1});

  const Audit audit = audit_of(files);

  EXPECT_EQ(audit.collisions_robot, 1U);
  EXPECT_NEAR(*audit.min_robot_gap_m, -0.4, 1e-9);
  EXPECT_EQ(audit.outside_bounds, 1U);
}

TEST(Audit, FailsARunInWhichARobotLeftTheWorld) {
  SyntheticRun files(2);
  std::vector<Vec2> strays = straight({5, 5}, {5, -0.1}, 10);
  for (const Vec2& p : straight({5, -0.1}, {30, 5}, 200)) strays.push_back(p);
  files.write(0, {.positions_m = strays});
  files.write(1, {.positions_m = straight({5, 15}, {30, 15}, 200), .goal = 1});

  const Audit audit = audit_of(files);

  EXPECT_EQ(audit.outside_bounds, 1U);
  EXPECT_EQ(audit.reasons, (std::vector<std::string>{"1 left the world's bounds: robot 0"}));
}

TEST(Audit, LetsTheFallenLieWhereTheyFell) {
  SyntheticRun files(3);
  files.write(0, {.positions_m = straight({5, 5}, {12, 5}, 50), .graceful = false});
  files.write(1, {.positions_m = straight({2, 5}, {30, 5}, 400)});
  files.write(2, {.positions_m = straight({5, 15}, {30, 15}, 200), .goal = 1});

  const Audit audit = audit_of(files);

  EXPECT_EQ(audit.collisions_fallen, 1U);
  EXPECT_EQ(audit.collisions_robot, 0U);
  EXPECT_EQ(audit.reasons.back(), "1 pair touched after one had died: 0-1");
}

TEST(Audit, LetsAFallenBodyLieUntilItIsCleared) {
  SyntheticRun files(2);
  files.write(0, {.positions_m = straight({5, 5}, {12, 5}, 50), .graceful = false});
  files.write(1, {.positions_m = straight({2, 5}, {30, 5}, 400), .goal = 1});
  auto run = read_run(files.dir());
  ASSERT_TRUE(run.has_value());
  // Robot 1 is at robot 0's last place, (12, 5), after 14.3 s.
  const auto change = [&](const SceneChange& c, double time_s) {
    auto next = after(run->scenes.back(), c, run->mission.world, run->begin + from_seconds(time_s));
    ASSERT_TRUE(next.has_value()) << next.error().message;
    run->scenes.push_back(*next);
  };
  change(AddBody{RobotId(0), Circle{{12, 5}, 0.3}}, 7.0);
  const auto collisions = [&] { return audit_recorded(*run).audit.collisions_fallen; };

  EXPECT_EQ(collisions(), 1U);
  change(ClearBody{RobotId(0)}, 12.0);
  EXPECT_EQ(collisions(), 0U);
}

TEST(Audit, FindsRobotsInObstacles) {
  SyntheticRun files(2);
  files.write(0, {.positions_m = straight({5, 10}, {30, 10}, 100)});
  files.write(1, {.positions_m = straight({5, 15}, {30, 15}, 100), .goal = 1});

  const Audit audit = audit_of(files);

  EXPECT_EQ(audit.collisions_obstacle, 1U);
  EXPECT_NEAR(*audit.min_obstacle_gap_m, -2.2, 1e-6);
}

TEST(Audit, ChecksTheSharesOfTheGoals) {
  SyntheticRun files(8);
  for (std::uint32_t i = 0; i < 8; ++i) {
    files.write(i, {.positions_m = straight({4, 2.0 + i}, {30, 3.0 + 0.6 * i}, 300)});
  }

  const Audit audit = audit_of(files);

  // Seven of eight end in the ellipse of goal 0, all of them wanted to: 4 ± 2 would be right.
  EXPECT_EQ(audit.arrived_per_goal[1], 0U);
  bool found = false;
  for (const auto& reason : audit.reasons) found = found || reason.starts_with("goal 1 got 0");
  EXPECT_TRUE(found);
}

TEST(Audit, JudgesRobotsThatFillADrawingByItsShapeFunction) {
  SyntheticRun files(8);
  files.write_good_run();  // four robots end near (30, 5), four near (30, 15)
  auto run = read_run(files.dir());
  ASSERT_TRUE(run) << run.error().message;
  auto shape = ShapeField::make({}, {Box{{27, 2}, {33, 8}}});
  ASSERT_TRUE(shape) << shape.error().message;
  run->mission.goal_shape = std::make_shared<const ShapeField>(*std::move(shape));

  EXPECT_EQ(audit_recorded(*run).audit.arrived, 8U) << "in their goals";

  run->mission.control.shape_tolerance_m2 = 0.1;
  const Audit audit = audit_recorded(*run).audit;
  EXPECT_EQ(audit.arrived, 4U);
  ASSERT_EQ(audit.reasons.size(), 1U) << "robots in the drawing are not counted by goal";
  EXPECT_EQ(audit.reasons[0], "4 not arrived: robot 1, 3, 5, 7");
}

TEST(Audit, MeasuresTheMissionFromFirstMotionToLastArrival) {
  SyntheticRun files(2);
  files.write(0, {.positions_m = straight({5, 5}, {30, 5}, 300), .moves_from = 20});
  files.write(1, {.positions_m = straight({5, 15}, {30, 15}, 400),
                  .goal = 1,
                  .moves_from = 50,
                  .arrives_at = 350});

  EXPECT_NEAR(*audit_of(files).mission_s, 35.0 - 2.0, 1e-6);
}

TEST(Audit, MeasuresAStopFromItsStampToTheLastChangeOfPosition) {
  SyntheticRun files(8);
  files.write_good_run();
  auto run = read_run(files.dir());
  ASSERT_TRUE(run.has_value());
  Track& track = run->tracks[2];
  double at_rest_s = 0.0;
  for (std::size_t i = 1; i < track.points.size(); ++i) {
    if (track.points[i].position_m != track.points[i - 1].position_m)
      at_rest_s = track.points[i].time_s;
  }
  const UtcTime commanded = run->begin + from_seconds(at_rest_s - 0.3);
  track.notes.push_back(
      {.stamp = commanded, .caused = commanded, .code = "mode", .text = "stopped"});

  const Audit audit = audit_recorded(*run).audit;

  ASSERT_TRUE(audit.stop.has_value());
  EXPECT_NEAR(audit.stop->max_ms, 300.0, 1e-3);  // nanosecond stamps
  EXPECT_FALSE(audit_of(files).stop.has_value());
}

TEST(Audit, CountsLateStepsAndRefusedMessages) {
  SyntheticRun files(2);
  files.write(
      0,
      {.positions_m = straight({5, 5}, {30, 5}, 99), .lateness_us = 20'001, .refused = {0, 3, 4}});
  files.write(1, {.positions_m = straight({5, 15}, {30, 15}, 99),
                  .goal = 1,
                  .lateness_us = 20'000,
                  .refused = {1}});

  const Audit audit = audit_of(files);

  EXPECT_NEAR(audit.deadline_miss_ratio, 0.5, 1e-12);
  EXPECT_EQ(audit.refused_messages, 8U);
}

TEST(Audit, CarriesOverOnlyWhatTheLauncherMeasured) {
  SyntheticRun files(2);
  files.write_good_run();
  files.write_file("summary.json",
                   R"({"plan_ms": 12.5, "cpu_s": 3, "discovery_s": null, "arrived": 99})");

  const Audit audit = audit_of(files);

  EXPECT_EQ(audit.plan_ms, 12.5);
  EXPECT_EQ(audit.cpu_s, 3.0);
  EXPECT_FALSE(audit.discovery_s.has_value());
  EXPECT_FALSE(audit.max_rss_mb.has_value());
  EXPECT_EQ(audit.arrived, 2U);
}

TEST(Audit, SurvivesADamagedRobotLog) {
  SyntheticRun files(2);
  files.write_good_run();
  const auto box = robot_log::file_of(files.dir(), RobotId(1));
  std::fstream file(box, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(4000);  // behind its schemas
  file.write("\x01\x02\x03", 3);
  file.close();

  const Audit audit = audit_of(files);

  EXPECT_EQ(audit.damaged_records, 1U);
  EXPECT_EQ(audit.arrived, 2U);
  EXPECT_EQ(audit.reasons, (std::vector<std::string>{"missing: 1 record of robot logs: robot 1"}));
}

TEST(Audit, ReportsTheMessageRateOfRobots) {
  SyntheticRun files(2);
  files.write(0, {.positions_m = straight({5, 5}, {12, 5}, 100), .states_sent = 20});
  files.write(1, {.positions_m = straight({5, 15}, {12, 15}, 100), .states_sent = 30});

  const Audit audit = audit_of(files);

  ASSERT_TRUE(audit.states_hz);
  EXPECT_NEAR(*audit.states_hz, 2.5, 1e-9);  // 50 in twice 10 s
}

TEST(Audit, IsADocumentWithEveryKey) {
  SyntheticRun files(1);
  files.write(0, {.positions_m = straight({5, 5}, {12, 5}, 100), .graceful = false});

  const auto json = nlohmann::json::parse(to_json(audit_of(files)));

  EXPECT_EQ(json["outcome"], "criteria_not_met");
  EXPECT_EQ(json["lost"], nlohmann::json::array({0}));
  for (const char* key : {"min_robot_gap_m", "mean_path_m", "geodesic_bound_m", "path_ratio",
                          "stop_latency_ms", "state_age_ms", "belief_error_cm", "plan_ms"}) {
    EXPECT_TRUE(json.at(key).is_null()) << key;
  }
  EXPECT_TRUE(json.at("tracking").at("swarm").is_null());
  EXPECT_EQ(json.size(), 30U);
}

}  // namespace
}  // namespace swarm::monitor
