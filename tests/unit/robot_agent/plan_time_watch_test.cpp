// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/plan_time_watch.hpp"

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::agent {
namespace {

SteadyTime at_s(double s) { return SteadyTime(from_seconds(1000.0 + s)); }

/// A planner whose wall clock is `apart_s` ahead of our steady clock; the plan's clock runs from 0.
PlanTimeWatch::Beat beat(double sent_s, double apart_s, std::uint32_t version = 1,
                         double rate = 1.0) {
  return {.version = version,
          .plan_time_s = sent_s,
          .rate = rate,
          .stamp_utc_ns = static_cast<std::int64_t>((1000.0 + sent_s + apart_s) * 1e9)};
}

TEST(PlanTimeWatch, KnowsNothingBeforeAHeartbeatOfItsPlan) {
  PlanTimeWatch sut(std::chrono::seconds(2));
  EXPECT_FALSE(sut.at(at_s(0)));
  sut.on_plan(2, false);
  sut.on_heartbeat(beat(5, 0, 1), at_s(5));
  EXPECT_FALSE(sut.at(at_s(5)));
  sut.on_heartbeat(beat(5, 0, 2), at_s(5));
  EXPECT_NEAR(sut.at(at_s(6))->plan_time_s, 6.0, 1e-6);
}

TEST(PlanTimeWatch, AHeartbeatMayComeBeforeItsPlan) {
  PlanTimeWatch sut(std::chrono::seconds(2));
  sut.on_heartbeat(beat(3, 0, 7), at_s(3));
  sut.on_plan(7, false);
  EXPECT_NEAR(sut.at(at_s(4))->plan_time_s, 4.0, 1e-6);
}

TEST(PlanTimeWatch, StopsWithoutHeartbeats) {
  PlanTimeWatch sut(std::chrono::seconds(2));
  sut.on_plan(1, false);
  sut.on_heartbeat(beat(10, 0), at_s(10));

  EXPECT_NEAR(sut.at(at_s(11.5))->plan_time_s, 11.5, 1e-6);
  EXPECT_NEAR(sut.at(at_s(30))->plan_time_s, 12.0, 1e-6);
  EXPECT_EQ(sut.at(at_s(30))->rate, 0.0);
}

TEST(PlanTimeWatch, FollowsTheRate) {
  PlanTimeWatch sut(std::chrono::seconds(2));
  sut.on_plan(1, false);
  sut.on_heartbeat(beat(10, 0, 1, 0.5), at_s(10));

  EXPECT_NEAR(sut.at(at_s(11))->plan_time_s, 10.5, 1e-6);
  EXPECT_EQ(sut.at(at_s(11))->rate, 0.5);
}

/// Whatever the wall clocks show, τ is right within the delay of the quickest heartbeat.
TEST(PlanTimeWatch, DoesNotDependOnWallClocks) {
  for (const double apart_s : {-3600.0, -0.3, 0.0, 0.3, 1.7e9}) {
    PlanTimeWatch sut(std::chrono::seconds(2));
    sut.on_plan(1, false);
    Rng rng(3);
    for (int i = 0; i < 200; ++i) {
      const double sent_s = 0.2 * i;
      const double delay_s = 0.02 + 0.15 * uniform01(rng);
      sut.on_heartbeat(beat(sent_s, apart_s), at_s(sent_s + delay_s));
      const double now_s = sent_s + 0.19;
      // The first heartbeats may all have been slow ones.
      EXPECT_NEAR(sut.at(at_s(now_s))->plan_time_s, now_s, i < 20 ? 0.18 : 0.05) << apart_s;
    }
  }
}

TEST(PlanTimeWatch, SurvivesAPlannersClockThatIsSetBack) {
  PlanTimeWatch sut(std::chrono::seconds(2));
  sut.on_plan(1, false);
  double worst = 0.0;
  for (int i = 0; i < 100; ++i) {
    const double sent_s = 0.2 * i;
    sut.on_heartbeat(beat(sent_s, i < 50 ? 0.0 : -20.0), at_s(sent_s + 0.01));
    worst = std::max(worst, std::abs(sut.at(at_s(sent_s + 0.1))->plan_time_s - sent_s - 0.1));
  }
  EXPECT_LT(worst, 0.02);
}

TEST(PlanTimeWatch, NeverGoesBackUnderTheSameFlow) {
  PlanTimeWatch sut(std::chrono::seconds(2));
  sut.on_plan(1, false);
  sut.on_heartbeat(beat(50, 0), at_s(50));
  EXPECT_NEAR(sut.at(at_s(50.5))->plan_time_s, 50.5, 1e-6);

  sut.on_plan(1, true);  // a restarted planner, whose clock has yet to catch up
  auto fresh = beat(51, 0);
  fresh.plan_time_s = 0.0;
  sut.on_heartbeat(fresh, at_s(51));
  EXPECT_NEAR(sut.at(at_s(51.2))->plan_time_s, 50.5, 1e-6);
  EXPECT_EQ(sut.at(at_s(51.2))->rate, 0.0);

  fresh = beat(52, 0);
  fresh.plan_time_s = 50.6;
  sut.on_heartbeat(fresh, at_s(52));
  EXPECT_NEAR(sut.at(at_s(52.1))->plan_time_s, 50.7, 1e-6);
}

TEST(PlanTimeWatch, StartsOverWithAnotherFlow) {
  PlanTimeWatch sut(std::chrono::seconds(2));
  sut.on_plan(1, false);
  sut.on_heartbeat(beat(50, 0), at_s(50));
  EXPECT_NEAR(sut.at(at_s(50))->plan_time_s, 50.0, 1e-6);

  sut.on_plan(2, false);
  EXPECT_FALSE(sut.at(at_s(51)));
  auto fresh = beat(51, 0, 2);
  fresh.plan_time_s = 0.5;
  sut.on_heartbeat(fresh, at_s(51));
  EXPECT_NEAR(sut.at(at_s(51.2))->plan_time_s, 0.7, 1e-6);
}

// A planner that is restarted while robots are under way plans again from where they are: another
// flow, under version 1 as the first one was.
TEST(PlanTimeWatch, StartsOverWithAnotherFlowUnderTheSameVersion) {
  PlanTimeWatch sut(std::chrono::seconds(2));
  sut.on_plan(1, false);
  sut.on_heartbeat(beat(50, 0), at_s(50));
  EXPECT_NEAR(sut.at(at_s(50))->plan_time_s, 50.0, 1e-6);

  sut.on_plan(1, false);
  EXPECT_FALSE(sut.at(at_s(53)));
  auto fresh = beat(53, 0);
  fresh.plan_time_s = 0.5;
  sut.on_heartbeat(fresh, at_s(53));
  EXPECT_NEAR(sut.at(at_s(53.2))->plan_time_s, 0.7, 1e-6);
  EXPECT_EQ(sut.at(at_s(53.2))->rate, 1.0);
}

}  // namespace
}  // namespace swarm::agent
