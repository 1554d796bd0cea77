// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/own_reference.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "swarm_monitor/audit/quantile.hpp"
#include "swarm_monitor/audit/tracking/plan_timeline.hpp"

namespace swarm::monitor {
namespace {

/// A plan from x = 0 to x = 100 m at 1 m/s, published at second 0: the reference at τ is (τ, 0).
RecordedRun run_at_one_mps() {
  RecordedRun run;
  run.begin = UtcTime(std::chrono::seconds(1000));
  auto plan = FlowPlan::make({{.gaussian = Gaussian::from_valid({0, 0}, Mat2::Identity()),
                               .time = MissionTime(0),
                               .mass = 1},
                              {.gaussian = Gaussian::from_valid({100, 0}, Mat2::Identity()),
                               .time = MissionTime(100),
                               .mass = 1}},
                             {{.from = 0, .to = 1, .mass = 1.0}});
  EXPECT_TRUE(plan.has_value());
  run.plans = {{1, plan.value_or(FlowPlan{})}};
  run.clock = {{run.begin, 1, 0.0, 1.0}};
  return run;
}

/// A robot that logs its reference at every 0.25 s by a clock that is off, and that is `late_s`
/// behind the published one and `aside_m` beside it.
struct Robot {
  double late_s = 0.0;
  double aside_m = 0.0;
  double clock_off_s = 0.0;
  std::function<bool(double)> follows = [](double) { return true; };
  std::function<RobotMode(double)> mode = [](double) { return RobotMode::kMoving; };

  Track track(std::uint32_t id) const {
    Track track{.robot = RobotId(id), .ended_gracefully = true};
    for (int k = 0; k <= 400; ++k) {
      const double time_s = 0.25 * k;
      TrackPoint point{
          .time_s = time_s, .position_m = {time_s - late_s, aside_m}, .mode = mode(time_s)};
      if (follows(time_s)) {
        point.plan_version = 1;
        point.plan_time_s = static_cast<float>(time_s + clock_off_s);
        point.reference_x_m = point.plan_time_s;
      }
      track.points.push_back(point);
    }
    return track;
  }
};

OwnReference measured(RecordedRun& run, const std::vector<Robot>& robots) {
  for (const Robot& robot : robots) {
    run.tracks.push_back(robot.track(static_cast<std::uint32_t>(run.tracks.size())));
  }
  return own_reference(run, PlanTimeline(run).moments(10.0, 90.0, 1.0));
}

// References are logged as floats: 1e-5 m of 100 m, at 1 m/s 1e-5 s.
constexpr double kFloat = 1e-4;

TEST(OwnReference, ReportsTheQuantilesOfTheLags) {
  RecordedRun run = run_at_one_mps();
  const std::vector<double> lags_s{-4.0, -1.0, 0.0, 0.5, 1.0, 2.0, 3.0, 5.0, 6.0, 7.0};
  std::vector<Robot> robots;
  for (const double lag_s : lags_s) robots.push_back({.late_s = lag_s});

  const OwnReference own = measured(run, robots);

  ASSERT_TRUE(own.lag);
  std::vector<double> signed_s = lags_s, amounts_s = lags_s;
  for (double& amount : amounts_s) amount = std::abs(amount);
  EXPECT_NEAR(own.lag->p1_s, quantile(signed_s, 0.01), kFloat);
  EXPECT_NEAR(own.lag->p10_s, quantile(signed_s, 0.1), kFloat);
  EXPECT_NEAR(own.lag->p50_s, quantile(signed_s, 0.5), kFloat);
  EXPECT_NEAR(own.lag->p90_s, quantile(signed_s, 0.9), kFloat);
  EXPECT_NEAR(own.lag->p99_s, quantile(signed_s, 0.99), kFloat);
  EXPECT_NEAR(own.lag->amount_p90_s, quantile(amounts_s, 0.9), kFloat);
  EXPECT_NEAR(own.lag->amount_p99_s, quantile(amounts_s, 0.99), kFloat);
  ASSERT_EQ(own.moments.size(), 81U);
  for (const LagMoment& moment : own.moments) {
    EXPECT_NEAR(moment.p10_s, own.lag->p10_s, kFloat) << moment.time_s;
    EXPECT_NEAR(moment.p50_s, own.lag->p50_s, kFloat) << moment.time_s;
    EXPECT_NEAR(moment.p90_s, own.lag->p90_s, kFloat) << moment.time_s;
  }
}

TEST(OwnReference, CountsEarlyRobotsInTheAmountsAsLateOnes) {
  RecordedRun run = run_at_one_mps();

  const OwnReference own = measured(run, {{.late_s = -8.0}, {.late_s = -8.0}});

  ASSERT_TRUE(own.lag);
  EXPECT_NEAR(own.lag->p99_s, -8.0, kFloat);
  EXPECT_NEAR(own.lag->amount_p99_s, 8.0, kFloat);
}

TEST(OwnReference, MeasuresTheDistanceToTheReference) {
  RecordedRun run = run_at_one_mps();
  // 3 beside and 4 behind: 5 m. The lag is that of the nearest reference, the distance is not.
  const OwnReference own = measured(run, {{.late_s = 4.0, .aside_m = 3.0}, {}, {}});

  ASSERT_TRUE(own.error && own.lag);
  EXPECT_NEAR(own.error->p50_m, 0.0, kFloat);
  EXPECT_NEAR(own.error->p95_m, 5.0, kFloat);
  EXPECT_NEAR(own.error->rms_m, std::sqrt(25.0 / 3.0), kFloat);
  EXPECT_NEAR(own.lag->p99_s, 4.0, kFloat);
}

TEST(OwnReference, ExposesARobotWithAClockOfItsOwn) {
  RecordedRun run = run_at_one_mps();
  // It keeps to the references that it logged, 6 s behind the published clock.
  const OwnReference own = measured(run, {{.late_s = 6.0, .clock_off_s = -6.0}, {}});

  ASSERT_TRUE(own.lag && own.clock_error_s);
  EXPECT_NEAR(own.lag->p99_s, 6.0, kFloat);
  EXPECT_NEAR(*own.clock_error_s, 6.0, kFloat);
}

TEST(OwnReference, SharesOutTheTimeUnderWayInWhichAPlanWasFollowed) {
  RecordedRun run = run_at_one_mps();
  // Of two robots one follows only up to second 49.75: 40 of its 81 moments, from 10 to 49 s.
  Robot half{.follows = [](double time_s) { return time_s < 49.9; }};

  const OwnReference own = measured(run, {half, {}});

  EXPECT_NEAR(own.followed_share, (40.0 + 81.0) / 162.0, 1e-12);
}

TEST(OwnReference, TakesDistancesOnlyOfRobotsUnderWay) {
  RecordedRun run = run_at_one_mps();
  // At rest in its place from second 50 on: it would dilute the error, but is not late either.
  Robot arrived{.mode = [](double time_s) {
    return time_s < 50.0 ? RobotMode::kMoving : RobotMode::kArrived;
  }};
  arrived.aside_m = 2.0;

  const OwnReference own = measured(run, {arrived, {}});

  // 40 distances of 2 m, 81 of 0 m.
  ASSERT_TRUE(own.error && own.lag);
  EXPECT_NEAR(own.error->rms_m, std::sqrt(40.0 * 4.0 / 121.0), kFloat);
  EXPECT_EQ(own.moments.size(), 81U);
}

TEST(OwnReference, LooksOnlyAtThePlanInForce) {
  RecordedRun run = run_at_one_mps();
  // The second plan is published at second 50; the robot goes on with the first one.
  run.plans.push_back({2, run.plans[0].plan});
  run.clock.push_back({run.begin + from_seconds(50.0), 2, 0.0, 1.0});

  const OwnReference own = measured(run, {{.late_s = 1.0}});

  EXPECT_EQ(own.moments.size(), 40U) << "from 10 to 49 s";
  EXPECT_NEAR(own.followed_share, 40.0 / 81.0, 1e-12);
  ASSERT_TRUE(own.clock_error_s);
  EXPECT_NEAR(*own.clock_error_s, 0.0, kFloat);
}

TEST(OwnReference, IsEmptyIfNoRobotFollowsAPlan) {
  RecordedRun run = run_at_one_mps();
  Robot free{.follows = [](double) { return false; }};

  const OwnReference own = measured(run, {free, free});

  EXPECT_FALSE(own.lag || own.error || own.clock_error_s);
  EXPECT_EQ(own.followed_share, 0.0);
  EXPECT_TRUE(own.moments.empty());
}

}  // namespace
}  // namespace swarm::monitor
