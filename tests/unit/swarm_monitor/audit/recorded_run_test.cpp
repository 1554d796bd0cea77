// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/recorded_run.hpp"

#include <gtest/gtest.h>

#include "swarm_core/plan/plan_json.hpp"
#include "swarm_core/plan/planning_record.hpp"
#include "swarm_monitor/audit/tracking/density_course.hpp"
#include "tests/unit/swarm_monitor/synthetic_run.hpp"

namespace swarm::monitor {
namespace {

TEST(RecordedRun, CountsTimeFromTheFirstStepOfAll) {
  SyntheticRun files(2);
  files.write(0, {.positions_m = straight({5, 5}, {6, 5}, 10), .begin_s = 2.0});
  files.write(1, {.positions_m = straight({5, 9}, {6, 9}, 10), .begin_s = 0.5});

  const auto run = read_run(files.dir());

  ASSERT_TRUE(run.has_value()) << run.error().message;
  EXPECT_EQ(run->begin, at_s(0.5));
  EXPECT_NEAR(run->tracks[0].points.front().time_s, 1.5, 1e-9);
  EXPECT_EQ(run->tracks[1].points.front().time_s, 0.0);
}

TEST(RecordedRun, JoinsTheIncarnationsOfARobot) {
  SyntheticRun files(1);
  files.write(0, {.positions_m = straight({5, 5}, {6, 5}, 10),
                  .graceful = false,
                  .process_id = 7,
                  .refused = {1, 2},
                  .ages_us = {10, 20}});
  files.write(0, {.positions_m = straight({6, 5}, {8, 5}, 10),
                  .begin_s = 3.0,
                  .process_id = 8,
                  .refused = {0, 4},
                  .ages_us = {30}});

  const auto run = read_run(files.dir());

  ASSERT_TRUE(run.has_value());
  const Track& track = run->tracks[0];
  EXPECT_EQ(track.points.size(), 22U);
  EXPECT_EQ(track.processes, (std::vector<std::uint32_t>{7, 8}));
  EXPECT_TRUE(track.ended_gracefully);
  EXPECT_EQ(track.refused, 7U);
  EXPECT_EQ(track.state_age.count(), 3U);
}

TEST(RecordedRun, LeavesOutStepsBackInTime) {
  TrackMaker maker(RobotId(0), at_s(0.0));
  for (const double time_s : {0.0, 0.2, 0.1, 0.3}) {
    maker.add(robot_log::Step{.stamp = at_s(time_s)});
  }

  const Track track = maker.finish();

  EXPECT_EQ(track.points.size(), 3U);
  EXPECT_EQ(track.damaged, 1U);
}

TEST(RecordedRun, ReadsEventsAndLeavesOutWhatIsNone) {
  SyntheticRun files(1);
  files.write(0, {.positions_m = straight({5, 5}, {6, 5}, 10)});
  const std::string stamp = std::to_string(at_s(1.5).time_since_epoch().count());
  files.write_file("events.jsonl",
                   "{\"utc_ns\":" + stamp +
                       ",\"source\":\"planner\",\"severity\":\"info\",\"code\":\"plan\","
                       "\"text\":\"done\"}\nnot json\n[1]\n{\"utc_ns\":\"x\"}\n{\"utc_ns\": 1");

  const auto run = read_run(files.dir());

  ASSERT_TRUE(run.has_value());
  ASSERT_EQ(run->events.size(), 1U);
  EXPECT_NEAR(run->events[0].time_s, 1.5, 1e-9);
  EXPECT_EQ(run->events[0].code, "plan");
}

/// A plan that ends after the given time [s].
FlowPlan plan_of(double duration_s) {
  const Gaussian gaussian;
  const auto plan = FlowPlan::make(
      {{gaussian, MissionTime(0.0), 1.0}, {gaussian, MissionTime(duration_s), 1.0}}, {{0, 1, 1.0}});
  EXPECT_TRUE(plan.has_value());
  return plan.value_or(FlowPlan{});
}

TEST(RecordedRun, ReadsAllPlansByVersionAndTheirClock) {
  SyntheticRun files(1);
  files.write(0, {.positions_m = straight({5, 5}, {6, 5}, 10)});
  files.write_file("plan.json", to_json(plan_of(10.0)));
  files.write_file("plan-0002.json", to_json(plan_of(20.0)));
  files.write_file("plan-12345.json", to_json(plan_of(30.0)));
  files.write_file("plan-0003.json", "cut");
  files.write_file("plan_stats.json", to_json(plan_of(40.0)));
  files.write_file("plan-x.json", to_json(plan_of(50.0)));
  const PlanClock first{.stamp = at_s(0.5), .plan_version = 1, .plan_time_s = 0.0, .rate = 1.0};
  const PlanClock second{.stamp = at_s(0.8), .plan_version = 2, .plan_time_s = 0.0, .rate = 0.5};
  files.write_file("plan_clock.jsonl", plan_clock_line(first) + plan_clock_line(second));

  const auto run = read_run(files.dir());

  ASSERT_TRUE(run.has_value());
  ASSERT_EQ(run->plans.size(), 3U);
  const std::vector<std::pair<std::uint32_t, double>> expected{{1, 10.0}, {2, 20.0}, {12345, 30.0}};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(run->plans[i].version, expected[i].first);
    EXPECT_EQ(run->plans[i].plan.duration().count(), expected[i].second);
  }
  EXPECT_EQ(run->first_plan(), &run->plans[0].plan);
  ASSERT_EQ(run->clock.size(), 2U);
  EXPECT_EQ(run->clock[1].rate, 0.5);
}

TEST(RecordedRun, ReadsTheDensityCapOfThePlanningMethod) {
  SyntheticRun files(1);
  files.write(0, {.positions_m = straight({5, 5}, {6, 5}, 10)});
  EXPECT_FALSE(read_run(files.dir())->planning.has_value());

  files.write_file("planning.json", to_json(PlanningRecord{"mine", 2.05}));
  const auto capped = read_run(files.dir());
  files.write_file("planning.json", to_json(PlanningRecord{"other", std::nullopt}));
  const auto uncapped = read_run(files.dir());

  ASSERT_TRUE(capped->planning && uncapped->planning);
  EXPECT_EQ(capped->planning->method, "mine");
  EXPECT_EQ(density_cap_of(*capped), 2.05);
  EXPECT_EQ(density_cap_of(*uncapped), std::nullopt);
  for (const char* broken : {"", "{", "[]", "{\"method\": 7}", "{\"density_cap_per_m2\": 2}"}) {
    EXPECT_FALSE(planning_record_from_json(broken).has_value()) << broken;
  }
  for (const char* no_cap : {"-1", "0", "\"2\"", "null", "1e999"}) {
    const auto record = planning_record_from_json(std::string("{\"method\": \"m\", ") +
                                                  "\"density_cap_per_m2\": " + no_cap + "}");
    EXPECT_FALSE(record && record->density_cap_per_m2) << no_cap;
  }
}

TEST(RecordedRun, ReadsWhatARobotTakesAsItsReference) {
  TrackMaker maker(RobotId(0), at_s(0.0));
  maker.add(robot_log::Step{.stamp = at_s(0.1),
                            .plan_version = 3,
                            .plan_time_s = 12.5F,
                            .reference_x_m = 4.0F,
                            .reference_y_m = -2.5F});

  const Track track = maker.finish();

  ASSERT_EQ(track.points.size(), 1U);
  EXPECT_EQ(track.points[0].plan_version, 3U);
  EXPECT_EQ(track.points[0].plan_time_s, 12.5F);
  EXPECT_EQ(track.points[0].reference_m(), Vec2(4.0, -2.5));
}

TEST(RecordedRun, NeedsAMissionAndARobotLog) {
  SyntheticRun files(1);
  const auto without_logs = read_run(files.dir());
  ASSERT_FALSE(without_logs.has_value());
  EXPECT_EQ(without_logs.error().code, ErrorCode::kEnvironment);

  std::filesystem::remove(files.dir() / "mission.resolved.yaml");
  const auto without_mission = read_run(files.dir());
  ASSERT_FALSE(without_mission.has_value());
  EXPECT_EQ(without_mission.error().code, ErrorCode::kEnvironment);
}

}  // namespace
}  // namespace swarm::monitor
