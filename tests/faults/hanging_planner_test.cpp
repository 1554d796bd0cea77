// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A planner that runs and does nothing.
#include <csignal>

#include "tests/system/flown_run.hpp"

namespace swarm::test {
namespace {

TEST(HangingPlanner, IsNamedKilledAndRestarted) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  ASSERT_EQ(run.planners().size(), 1U);
  const pid_t hanging = run.planners().front();

  ::kill(hanging, SIGSTOP);

  EXPECT_TRUE(eventually([&] { return has_event(run.dir(), "silent-killed"); }));
  EXPECT_TRUE(eventually([&] {
    const auto planners = run.planners();
    return planners.size() == 1 && planners.front() != hanging;
  }));
  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_TRUE(has_event(run.dir(), "planner-silent"));
  EXPECT_TRUE(has_event(run.dir(), "respawn"));
  EXPECT_EQ(run.summary()["arrived"], 12);
  EXPECT_EQ(run.summary()["collisions_robot"], 0);
}

}  // namespace
}  // namespace swarm::test
