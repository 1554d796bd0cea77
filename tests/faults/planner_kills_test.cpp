// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A planner that is killed again and again, as soon as it is back.
#include <csignal>
#include <set>

#include "tests/system/flown_run.hpp"

namespace swarm::test {
namespace {

// More often than the mission's respawn_planner_max: robots hold while there is no planner.
TEST(KilledPlanner, ComesBackEachTimeAndTheSwarmArrives) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  std::set<pid_t> killed;
  for (int kills = 0; kills < 6; ++kills) {
    pid_t planner = 0;
    ASSERT_TRUE(eventually([&] {
      const auto planners = run.planners();
      planner = planners.empty() ? 0 : planners.front();
      return planner != 0 && !killed.contains(planner);
    })) << kills;
    killed.insert(planner);
    ::kill(planner, SIGKILL);
  }

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_EQ(run.summary()["arrived"], 12);
  EXPECT_EQ(run.summary()["collisions_robot"], 0);
}

}  // namespace
}  // namespace swarm::test
