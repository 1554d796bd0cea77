// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Agents that freeze in flight (SIGSTOP) and wake: their bodies stand, nothing of them is received.
#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include "flown_run.hpp"

namespace swarm::test {
namespace {

class FrozenAgents : public testing::TestWithParam<std::string> {};

TEST_P(FrozenAgents, AreNotTouchedAndArriveAfterTheyWake) {
  FlownRun run({"--channel", GetParam()});
  ASSERT_TRUE(run.mission_started());
  const std::vector<pid_t> agents = run.agents();
  ASSERT_EQ(agents.size(), 12U);
  std::this_thread::sleep_for(std::chrono::seconds(5));  // they are under way

  for (const std::size_t i : {1U, 4U, 9U}) ::kill(agents[i], SIGSTOP);
  EXPECT_TRUE(eventually([&] { return has_event(run.dir(), "agent-silent"); }));
  EXPECT_TRUE(eventually([&] { return has_event(run.dir(), "body-added"); }))
      << "a silent robot is an obstacle, as a dead one is";
  std::this_thread::sleep_for(std::chrono::seconds(2));
  for (const std::size_t i : {1U, 4U, 9U}) ::kill(agents[i], SIGCONT);

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  const auto summary = run.summary();
  EXPECT_EQ(summary["arrived"], 12);
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_EQ(summary["collisions_obstacle"], 0);
  EXPECT_TRUE(has_event(run.dir(), "body-cleared"));
  EXPECT_TRUE(has_event(run.dir(), "woke-late")) << "it receives before it moves";
  const auto bodies = first_bodies(run.dir());
  EXPECT_EQ(bodies.size(), 3U);
  for (const auto& [robot, radius_m] : bodies) {
    EXPECT_LE(radius_m, kLargestBody_m) << "the last step of robot " << robot << " is known";
  }
}

INSTANTIATE_TEST_SUITE_P(Channels, FrozenAgents, testing::Values("groups", "topics"),
                         [](const auto& channel) { return channel.param; });

TEST(FrozenLauncher, IsReportedAndRobotsFlyOn) {
  FlownRun run;  // launcher.on_launcher_loss: finish
  ASSERT_TRUE(run.mission_started());
  std::this_thread::sleep_for(std::chrono::seconds(3));
  run.launcher().signal(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::seconds(6));
  run.launcher().signal(SIGCONT);

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_EQ(run.summary()["collisions_robot"], 0);
  EXPECT_TRUE(has_event(run.dir(), "launcher-silent"));
  EXPECT_TRUE(has_event(run.dir(), "launcher-back"));
}

}  // namespace
}  // namespace swarm::test
