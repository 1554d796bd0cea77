// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Processes die (kill -9) in the middle of a mission.
#include <csignal>

#include "flown_run.hpp"

namespace swarm::test {
namespace {

TEST(Loss, KilledRobotsAreNamedAndNobodyElseIsDisturbed) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  const auto agents = run.agents();
  ASSERT_EQ(agents.size(), 12U);

  ::kill(agents[3], SIGKILL);
  ::kill(agents[8], SIGKILL);

  EXPECT_EQ(run.launcher().wait(), 1) << run.launcher().err();
  const auto summary = run.summary();
  EXPECT_EQ(summary["lost"], nlohmann::json({3, 8}));
  EXPECT_EQ(summary["arrived"], 10);
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_EQ(summary["collisions_obstacle"], 0);
}

TEST(Loss, TheSwarmOutlivesItsPlanner) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  const auto planners = run.planners();
  ASSERT_EQ(planners.size(), 1U);

  ::kill(planners[0], SIGKILL);

  EXPECT_EQ(run.launcher().wait(), 0) << run.launcher().err();
  EXPECT_TRUE(has_event(run.dir(), "respawn"));
  EXPECT_EQ(run.summary()["collisions_robot"], 0);
}

TEST(Loss, AFrozenPlannerMakesTheSwarmHoldAndItsReturnMakesItGoOn) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  const auto planners = run.planners();
  ASSERT_EQ(planners.size(), 1U);

  ::kill(planners[0], SIGSTOP);
  EXPECT_TRUE(eventually([&] { return has_event(run.dir(), "planner-silent"); }));
  ::kill(planners[0], SIGCONT);

  EXPECT_EQ(run.launcher().wait(), 0) << run.launcher().err();
}

TEST(Loss, NoOrphansWhenTheLauncherIsKilled) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  auto processes = run.agents();
  for (const pid_t planner : run.planners()) processes.push_back(planner);
  ASSERT_EQ(processes.size(), 13U);

  run.launcher().signal(SIGKILL);
  run.launcher().wait();

  for (const pid_t pid : processes) {
    EXPECT_TRUE(eventually([&] {
      const std::string stat = read_text("/proc/" + std::to_string(pid) + "/stat");
      return stat.empty() || stat.find(") Z ") != std::string::npos;
    })) << pid;
  }
}

}  // namespace
}  // namespace swarm::test
