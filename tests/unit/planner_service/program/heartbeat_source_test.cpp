// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/program/heartbeat_source.hpp"

#include <gtest/gtest.h>

namespace swarm::planner {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr SteadyTime kNow{seconds(100)};
constexpr UtcTime kUtc{seconds(1'000'000'000)};

PlannerState running(double plan_time_s, double rate, SteadyTime at = kNow) {
  return {.phase = MissionPhase::kRunning,
          .t0_utc_ns = (kUtc - seconds(7)).time_since_epoch().count(),
          .clock = {.plan_version = 3, .plan_time_s = plan_time_s, .rate = rate},
          .at = at};
}

TEST(HeartbeatSource, HasNoneBeforeTheFirstStep) {
  HeartbeatSource sut(PlannerEpoch(5), seconds(30));
  EXPECT_FALSE(sut.next(kNow, kUtc));
}

TEST(HeartbeatSource, ReportsTheStateOfTheStep) {
  HeartbeatSource sut(PlannerEpoch(5), seconds(30));
  sut.on_step(running(12.0, 0.5));
  const auto beat = sut.next(kNow, kUtc);
  ASSERT_TRUE(beat);
  EXPECT_EQ(beat->phase, MissionPhase::kRunning);
  EXPECT_EQ(beat->version, 3U);
  EXPECT_EQ(beat->epoch, 5U);
  EXPECT_EQ(beat->sequence_number, 1U);
  EXPECT_EQ(beat->stamp_utc_ns, kUtc.time_since_epoch().count());
  EXPECT_DOUBLE_EQ(beat->mission_time_s, 7.0);
  EXPECT_DOUBLE_EQ(beat->plan_time_s, 12.0);
  EXPECT_DOUBLE_EQ(beat->plan_rate, 0.5);
}

TEST(HeartbeatSource, HasNoMissionTimeBeforeTheStart) {
  HeartbeatSource sut(PlannerEpoch(5), seconds(30));
  sut.on_step({.at = kNow});
  EXPECT_EQ(sut.next(kNow, kUtc)->mission_time_s, 0.0);
}

TEST(HeartbeatSource, AdvancesTheClockAtItsRateWhileThePlannerPlans) {
  HeartbeatSource sut(PlannerEpoch(5), seconds(30));
  sut.on_step(running(12.0, 0.5));
  const auto beat = sut.next(kNow + seconds(4), kUtc + seconds(4));
  EXPECT_DOUBLE_EQ(beat->plan_time_s, 14.0);
  EXPECT_DOUBLE_EQ(sut.published().plan_time_s, 14.0);
  EXPECT_EQ(sut.published().plan_version, 3U);
  EXPECT_EQ(sut.next(kNow + seconds(4), kUtc)->sequence_number, 2U);
}

TEST(HeartbeatSource, TakesTheAgeOfTheStepFromTheSteadyClock) {
  HeartbeatSource sut(PlannerEpoch(5), seconds(30));
  sut.on_step(running(12.0, 1.0));
  EXPECT_DOUBLE_EQ(sut.next(kNow + seconds(1), kUtc - std::chrono::hours(1))->plan_time_s, 13.0);
}

TEST(HeartbeatSource, HasNoneWhileAStepHangs) {
  HeartbeatSource sut(PlannerEpoch(5), seconds(30));
  sut.on_step(running(12.0, 1.0));
  EXPECT_TRUE(sut.next(kNow + seconds(30), kUtc));
  EXPECT_FALSE(sut.next(kNow + seconds(30) + milliseconds(1), kUtc));
  sut.on_step(running(12.0, 1.0, kNow + seconds(40)));
  EXPECT_TRUE(sut.next(kNow + seconds(40), kUtc)) << "it went on";
}

}  // namespace
}  // namespace swarm::planner
