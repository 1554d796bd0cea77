// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/loop/motion_permit.hpp"

#include <chrono>

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;

SteadyTime at(int ms) { return SteadyTime(milliseconds(100'000 + ms)); }

class MotionPermitTest : public testing::Test {
 protected:
  /// Ticks of 100 ms in [from, to] with planner and launcher received at each; the last reason.
  StandReason healthy(int from_ms, int to_ms) {
    StandReason reason = StandReason::kNone;
    for (int ms = from_ms; ms <= to_ms; ms += 100) reason = tick(ms, ms, ms);
    return reason;
  }
  StandReason tick(int ms, std::optional<int> planner_ms, std::optional<int> launcher_ms,
                   bool all_cells = true) {
    const auto time = [](std::optional<int> t) { return t ? std::optional(at(*t)) : std::nullopt; };
    return sut_.update({.now = at(ms),
                        .planner = time(planner_ms),
                        .launcher = time(launcher_ms),
                        .all_cells = all_cells});
  }

  MotionPermit sut_{{.period = milliseconds(100),
                     .full_interval = milliseconds(700),
                     .cut_off_after = milliseconds(2000),
                     .rejoin_interval = milliseconds(5000)}};
};

TEST_F(MotionPermitTest, StandsBeforePlannerOrLauncherIsReceived) {
  EXPECT_EQ(tick(0, {}, {}), StandReason::kCutOff);
  EXPECT_EQ(tick(100, 100, {}), StandReason::kNone);
}

TEST_F(MotionPermitTest, StandsWhenNeitherPlannerNorLauncherIsReceived) {
  healthy(0, 1000);
  for (int ms = 1100; ms <= 3000; ms += 100) EXPECT_EQ(tick(ms, 1000, 1000), StandReason::kNone);
  EXPECT_EQ(tick(3100, 1000, 1000), StandReason::kCutOff);
  for (int ms = 3200; ms < 8200; ms += 100) {
    EXPECT_EQ(tick(ms, 1000, ms), StandReason::kCutOff) << "who fell silent meanwhile?";
  }
  EXPECT_EQ(tick(8200, 1000, 8200), StandReason::kNone) << "the planner alone is dead";
  for (int ms = 8300; ms <= 12'000; ms += 100) EXPECT_EQ(tick(ms, ms, 8200), StandReason::kNone);
}

TEST_F(MotionPermitTest, ReceivesForAFullIntervalAfterAPauseLongerThanACommand) {
  healthy(0, 1000);
  EXPECT_EQ(tick(1200, 1200, 1200), StandReason::kNone) << "late, but the command lasts";
  EXPECT_EQ(tick(1410, 1410, 1410), StandReason::kWaking);
  EXPECT_EQ(healthy(1500, 2100), StandReason::kWaking);
  EXPECT_EQ(tick(2200, 2200, 2200), StandReason::kNone);
}

TEST_F(MotionPermitTest, DoesNotCountWhatHasWaitedInTheSocketsWhileItSlept) {
  healthy(0, 1000);
  for (int ms = 11'000; ms <= 11'600; ms += 100) {
    EXPECT_EQ(tick(ms, 11'000, 11'000), StandReason::kWaking);
  }
  EXPECT_EQ(tick(11'700, 11'000, 11'000), StandReason::kCutOff);
  for (int ms = 11'800; ms < 16'000; ms += 100) {
    EXPECT_EQ(tick(ms, ms, ms), StandReason::kCutOff) << "it may have been cut off meanwhile";
  }
  EXPECT_EQ(tick(16'000, 16'000, 16'000), StandReason::kNone);
}

TEST_F(MotionPermitTest, GoesOnSoonAfterAShortSleep) {
  healthy(0, 1000);
  EXPECT_EQ(healthy(2900, 3500), StandReason::kWaking);
  EXPECT_EQ(tick(3600, 3600, 3600), StandReason::kNone);
}

TEST_F(MotionPermitTest, StandsWhileACellCannotBeReceived) {
  healthy(0, 1000);
  EXPECT_EQ(tick(1100, 1100, 1100, false), StandReason::kCellsMissing);
  EXPECT_EQ(tick(1200, 1200, 1200), StandReason::kNone);
  EXPECT_EQ(sut_.update({.now = at(1300), .all_cells = false, .lacks_files = true}),
            StandReason::kFilesMissing);
}

TEST_F(MotionPermitTest, StandsWhereTheSceneHasItsBodyUntilThatIsCleared) {
  healthy(0, 1000);
  const auto tick_as_obstacle = [&](int ms, bool is_obstacle) {
    return sut_.update(
        {.now = at(ms), .planner = at(ms), .launcher = at(ms), .is_obstacle = is_obstacle});
  };
  EXPECT_EQ(tick_as_obstacle(1100, true), StandReason::kIsObstacle) << "receives all the same";
  EXPECT_EQ(tick_as_obstacle(1200, true), StandReason::kIsObstacle);
  EXPECT_EQ(tick_as_obstacle(1300, false), StandReason::kNone);
}

}  // namespace
}  // namespace swarm::agent
