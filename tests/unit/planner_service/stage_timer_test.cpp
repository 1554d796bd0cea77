// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/stage_timer.hpp"

#include <gtest/gtest.h>

namespace swarm::planner {
namespace {

TEST(StageTimer, LapsAddUpToTheTimeThatPassed) {
  SteadyTime now{std::chrono::seconds(3)};
  const StageClock clock = [&] { return now; };
  StageTimer timer(clock);

  now += std::chrono::microseconds(1500);
  EXPECT_NEAR(timer.lap_ms(), 1.5, 1e-9);
  EXPECT_EQ(timer.lap_ms(), 0.0);
  now += std::chrono::seconds(2);
  EXPECT_NEAR(timer.lap_ms(), 2000.0, 1e-9);
}

}  // namespace
}  // namespace swarm::planner
