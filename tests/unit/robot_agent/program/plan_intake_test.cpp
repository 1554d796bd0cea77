// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/program/plan_intake.hpp"

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

NewPlan new_plan(double x_m) {
  return {.flow = FlowPlan::make(
                      {{Gaussian::from_parameters({x_m, 0}, 1, 1, 0), MissionTime(0), 1}}, {})
                      .value(),
          .entries = {}};
}

TEST(PlanIntake, HandsAPlanOnOnceAndAtOnceWhereItDoesNotWait) {
  PlanIntake sut(false);
  const SteadyTime now{seconds(5)};
  EXPECT_FALSE(sut.take(now, true).has_value());
  sut.receive(new_plan(8), now);
  sut.receive(std::nullopt, now);

  EXPECT_TRUE(sut.take(now, false).has_value());
  EXPECT_FALSE(sut.take(now, false).has_value());
}

TEST(PlanIntake, HoldsAPlanBackUntilItsClockIsKnownOrASecondIsOver) {
  for (const bool clock_comes : {true, false}) {
    PlanIntake sut(true);
    const SteadyTime now{seconds(5)};
    sut.receive(new_plan(8), now);

    EXPECT_FALSE(sut.take(now, false).has_value());
    EXPECT_FALSE(sut.take(now + milliseconds(999), false).has_value());
    EXPECT_TRUE(sut.take(now + milliseconds(clock_comes ? 999 : 1000), clock_comes).has_value());
  }
}

TEST(PlanIntake, ReplacesAPlanThatWaits) {
  PlanIntake sut(true);
  const SteadyTime now{seconds(5)};
  sut.receive(new_plan(8), now);
  sut.receive(new_plan(9), now + milliseconds(500));

  EXPECT_EQ(sut.take(now + milliseconds(500), true).value().plan.flow.digest(),
            new_plan(9).flow.digest());
}

TEST(PlanIntake, RepeatsThePlanOnceAfterASceneThatNoNewPlanFollows) {
  PlanIntake sut(false);
  const SteadyTime now{seconds(5)};
  sut.on_scene(now);
  EXPECT_FALSE(sut.take(now + kReplanTimeout, true).has_value()) << "there is none yet";
  sut.receive(new_plan(8), now);
  EXPECT_FALSE(sut.take(now, true).value().again);
  EXPECT_FALSE(sut.take(now + kReplanTimeout, true).has_value()) << "it came after the scene";

  sut.on_scene(now + seconds(10));
  EXPECT_FALSE(sut.take(now + seconds(10) + kReplanTimeout - milliseconds(1), true).has_value());
  const auto repeated = sut.take(now + seconds(10) + kReplanTimeout, true);
  ASSERT_TRUE(repeated.has_value());
  EXPECT_TRUE(repeated->again);
  EXPECT_EQ(repeated->plan.flow.digest(), new_plan(8).flow.digest());
  EXPECT_FALSE(sut.take(now + seconds(99), true).has_value());
}

}  // namespace
}  // namespace swarm::agent
