// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/fallen_bodies.hpp"

#include <gtest/gtest.h>

#include "swarm_core/robot_log/last_step.hpp"

namespace swarm::monitor {
namespace {

const UtcTime kBegin(std::chrono::seconds(1'800'000'000));

/// A robot whose steps are at these times.
Track track_of(std::uint32_t robot, std::vector<double> times_s, bool gracefully) {
  Track track{.robot = RobotId(robot), .ended_gracefully = gracefully};
  for (const double time_s : times_s) track.points.push_back({.time_s = time_s});
  return track;
}

/// A run with the scenes after these changes, each at a time since the begin.
RecordedRun run_with(std::vector<Track> tracks,
                     const std::vector<std::pair<double, SceneChange>>& changes,
                     std::vector<RunEvent> events = {}) {
  RecordedRun run;
  run.events = std::move(events);
  run.begin = kBegin;
  run.tracks = std::move(tracks);
  run.scenes = {first_scene(0)};
  for (const auto& [time_s, change] : changes) {
    auto next = after(run.scenes.back(), change, run.mission.world, kBegin + from_seconds(time_s));
    EXPECT_TRUE(next.has_value()) << next.error().message;
    run.scenes.push_back(*next);
  }
  lay_fallen_bodies(run);
  return run;
}

AddBody falls(std::uint32_t robot) { return {RobotId(robot), Circle{{0, 0}, 0.5}}; }
ClearBody is_cleared(std::uint32_t robot) { return {RobotId(robot)}; }

bool has_body(const Track& track) { return track.body_until_s >= track.points.back().time_s; }

TEST(FallenBodies, LieUntilTheEndOfTheRun) {
  const RecordedRun run =
      run_with({track_of(0, {0, 10, 30}, true), track_of(1, {0, 5}, false)}, {{7.0, falls(1)}});

  EXPECT_EQ(run.tracks[1].body_until_s, 30.0);
  EXPECT_FALSE(has_body(run.tracks[0])) << "it ended gracefully";
}

TEST(FallenBodies, LieAlsoIfNoSceneRecordedThem) {
  const RecordedRun run = run_with({track_of(0, {0, 30}, true), track_of(1, {0, 5}, false)}, {});

  EXPECT_EQ(run.tracks[1].body_until_s, 30.0);
}

// A full disk: the launcher has received the robot after the end of its log. A body in the middle
// of the circle, and a straight path to it, would be contacts that were not recorded.
TEST(FallenBodies, AreNotJudgedWhereTheLogLacksItsEnd) {
  const AddBody falls_elsewhere{RobotId(1), Circle{{3, 4}, 2.0}};
  const RecordedRun run =
      run_with({track_of(0, {0, 30}, true), track_of(1, {0, 5}, false)}, {{7.0, falls_elsewhere}});

  const Track& track = run.tracks[1];
  EXPECT_EQ(track.points.size(), 2U);
  EXPECT_EQ(track.lost, 1U) << "an incomplete log: the verdict is never ok";
  EXPECT_EQ(track.body_until_s, 0.0);
}

TEST(FallenBodies, AreNotJudgedWhereTheLauncherFoundTheLogIncomplete) {
  const RunEvent event{.time_s = 7.0,
                       .source = "launcher",
                       .severity = "warning",
                       .code = "log-incomplete",
                       .text = "robot 1: its log ends 1.2 s before its last step"};
  const auto fly = [&](double log_end_s) {
    return run_with({track_of(0, {0, 30}, true), track_of(1, {0, log_end_s}, false)},
                    {{7.0, falls(1)}}, {event});
  };

  EXPECT_EQ(fly(5.0).tracks[1].body_until_s, 0.0);
  EXPECT_EQ(fly(5.0).tracks[1].lost, 1U);
  EXPECT_TRUE(has_body(fly(8.0).tracks[1])) << "it was frozen, and has written its log since";
}

RunEvent last_step(std::uint32_t robot, double time_s, const Vec2& position_m, const Vec2& v_mps) {
  return {.time_s = time_s + 0.1,
          .source = "launcher",
          .severity = "info",
          .code = "last-step",
          .text = to_text(robot_log::LastStep{.robot = RobotId(robot),
                                              .stamp = kBegin + from_seconds(time_s),
                                              .position_m = position_m,
                                              .velocity_mps = v_mps})};
}

// A killed process has not handed its last records to the disk.
TEST(FallenBodies, LieWhereTheLauncherHasTheLastStep) {
  const AddBody falls_there{RobotId(1), Circle{{3.2, 4}, 0.4}};
  const RecordedRun run = run_with({track_of(0, {0, 30}, true), track_of(1, {0, 5}, false)},
                                   {{5.5, falls_there}}, {last_step(1, 5.4, {3, 4}, {2, 0})});

  const Track& track = run.tracks[1];
  ASSERT_EQ(track.points.size(), 4U);
  EXPECT_NEAR(track.points[2].time_s, 5.4, 1e-9);
  EXPECT_EQ(track.points[2].position_m, Vec2(3, 4));
  EXPECT_NEAR(track.points[3].time_s, 5.6, 1e-9) << "two control periods";
  EXPECT_NEAR((track.points[3].position_m - Vec2(3.4, 4)).norm(), 0.0, 1e-9);
  EXPECT_EQ(track.lost, 0U);
  EXPECT_EQ(track.body_until_s, 30.0);
}

TEST(FallenBodies, HaveNoLastStepWhereTheLogHasItOrLacksALongTime) {
  const auto points_with = [](const RunEvent& event) {
    return run_with({track_of(0, {0, 30}, true), track_of(1, {0, 5, 5.2}, false)}, {}, {event})
        .tracks[1]
        .points.size();
  };

  EXPECT_EQ(points_with(last_step(1, 5.2, {3, 4}, {2, 0})), 3U) << "it has that step";
  EXPECT_EQ(points_with(last_step(1, 7.4, {3, 4}, {2, 0})), 5U);
  EXPECT_EQ(points_with(last_step(1, 7.6, {3, 4}, {2, 0})), 3U) << "its path is not known";
  EXPECT_EQ(points_with(last_step(7, 5.4, {3, 4}, {2, 0})), 3U) << "no robot of the mission";
  RunEvent damaged = last_step(1, 5.4, {3, 4}, {2, 0});
  damaged.text.pop_back();
  EXPECT_EQ(points_with(damaged), 3U);
  RunEvent of_a_robot = last_step(1, 5.4, {3, 4}, {2, 0});
  of_a_robot.source = "robot-0";
  EXPECT_EQ(points_with(of_a_robot), 3U);
}

// The reader lets the body come to rest after the last step that the log has.
TEST(FallenBodies, ComeToRestAfterTheLastStepOnly) {
  Track track = track_of(1, {0, 5, 5.2}, false);
  track.points.back().is_rest = true;

  const RecordedRun run = run_with({track_of(0, {0, 30}, true), std::move(track)}, {},
                                   {last_step(1, 5.1, {3, 4}, {2, 0})});

  const std::vector<TrackPoint>& points = run.tracks[1].points;
  ASSERT_EQ(points.size(), 4U);
  EXPECT_NEAR(points[2].time_s, 5.1, 1e-9);
  EXPECT_FALSE(points[2].is_rest);
  EXPECT_NEAR(points[3].time_s, 5.3, 1e-9);
  EXPECT_TRUE(points[3].is_rest);
}

TEST(FallenBodies, HaveNoLastStepWhereTheLogIsReportedIncomplete) {
  const RunEvent step = last_step(1, 5.9, {3, 4}, {2, 0});
  const RunEvent incomplete{.time_s = step.time_s,
                            .source = "launcher",
                            .severity = "warning",
                            .code = "log-incomplete",
                            .text = "robot 1: its log ends 0.9 s before its last step"};

  const RecordedRun run =
      run_with({track_of(0, {0, 30}, true), track_of(1, {0, 5}, false)}, {}, {step, incomplete});

  EXPECT_EQ(run.tracks[1].points.size(), 2U);
  EXPECT_EQ(run.tracks[1].lost, 1U);
  EXPECT_EQ(run.tracks[1].body_until_s, 0.0);
}

// It came back and drove on.
TEST(FallenBodies, OfAnEarlierIncarnationHaveTheirLastStepInTheMiddle) {
  const RecordedRun run = run_with({track_of(0, {0, 30}, true), track_of(1, {0, 5, 9, 20}, true)},
                                   {}, {last_step(1, 5.4, {3, 4}, {0, 0})});

  ASSERT_EQ(run.tracks[1].points.size(), 6U);
  EXPECT_EQ(run.tracks[1].points[2].position_m, Vec2(3, 4));
  EXPECT_NEAR(run.tracks[1].points[4].time_s, 9.0, 1e-9);
}

TEST(FallenBodies, OfARobotThatCameBackLeaveItsTrackAsItIs) {
  const AddBody falls_elsewhere{RobotId(1), Circle{{3, 4}, 2.0}};
  const RecordedRun run = run_with({track_of(0, {0, 30}, true), track_of(1, {0, 5, 20}, false)},
                                   {{7.0, falls_elsewhere}, {9.0, is_cleared(1)}});

  EXPECT_EQ(run.tracks[1].points.size(), 3U);
  EXPECT_EQ(run.tracks[1].lost, 0U);
}

TEST(FallenBodies, LieUntilTheyAreCleared) {
  const RecordedRun run = run_with({track_of(0, {0, 30}, true), track_of(1, {0, 5}, false)},
                                   {{7.0, falls(1)}, {12.5, is_cleared(1)}});

  EXPECT_NEAR(run.tracks[1].body_until_s, 12.5, 1e-9);
}

TEST(FallenBodies, OfARobotThatCameBackAndFellAgainLieFromItsSecondFall) {
  // It fell at second 5, came back at second 9 when its body was cleared, and fell at second 20.
  const RecordedRun run = run_with({track_of(0, {0, 40}, true), track_of(1, {0, 5, 10, 20}, false)},
                                   {{6.0, falls(1)}, {9.0, is_cleared(1)}, {22.0, falls(1)}});

  EXPECT_EQ(run.tracks[1].body_until_s, 40.0) << "the first body's end is not the second one's";
}

TEST(FallenBodies, AreEachClearedByThemselves) {
  const RecordedRun run =
      run_with({track_of(0, {0, 40}, true), track_of(1, {0, 5}, false), track_of(2, {0, 6}, false)},
               {{6.0, falls(1)}, {7.0, falls(2)}, {15.0, is_cleared(2)}, {30.0, is_cleared(1)}});

  EXPECT_NEAR(run.tracks[1].body_until_s, 30.0, 1e-9);
  EXPECT_NEAR(run.tracks[2].body_until_s, 15.0, 1e-9);
}

TEST(FallenBodies, ThatAreClearedAfterTheRunLieUntilItsEnd) {
  const RecordedRun run = run_with({track_of(0, {0, 30}, true), track_of(1, {0, 5}, false)},
                                   {{7.0, falls(1)}, {50.0, is_cleared(1)}});

  EXPECT_EQ(run.tracks[1].body_until_s, 30.0);
}

TEST(FallenBodies, OfARespawnedRobotAreItsTrack) {
  const RecordedRun run = run_with({track_of(0, {0, 40}, true), track_of(1, {0, 5, 10, 35}, true)},
                                   {{6.0, falls(1)}, {9.0, is_cleared(1)}});

  EXPECT_FALSE(has_body(run.tracks[1]));
}

TEST(FallenBodies, OfRobotsWithoutALogOrOfAnotherMissionAreNone) {
  // Robot 1 never logged a step, robot 7 is not of this mission.
  const RecordedRun run =
      run_with({track_of(0, {0, 40}, true), track_of(1, {}, false)},
               {{6.0, falls(1)}, {7.0, falls(7)}, {8.0, is_cleared(1)}, {9.0, is_cleared(7)}});

  EXPECT_EQ(run.tracks[1].body_until_s, 0.0);
}

}  // namespace
}  // namespace swarm::monitor
