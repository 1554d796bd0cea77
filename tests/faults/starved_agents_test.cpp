// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Agents that get a processor for a quarter of the time.
#include <chrono>
#include <csignal>
#include <thread>
#include <vector>

#include "tests/system/flown_run.hpp"

namespace swarm::test {
namespace {

// Stopped and continued in turn, so that it does not depend on the machine. Each pause is longer
// than a driver obeys a command, and shorter than the silence after which a robot is reported.
TEST(StarvedAgents, TouchNothingAndArrive) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started()) << run.outcome();
  const std::vector<pid_t> agents = run.agents();
  ASSERT_EQ(agents.size(), 12U);
  std::this_thread::sleep_for(std::chrono::seconds(3));  // they are under way

  for (int i = 0; i < 25; ++i) {
    for (const std::size_t agent : {1U, 4U, 9U}) ::kill(agents[agent], SIGSTOP);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    for (const std::size_t agent : {1U, 4U, 9U}) ::kill(agents[agent], SIGCONT);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  const auto summary = run.summary();
  EXPECT_EQ(summary["arrived"], 12);
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_EQ(summary["collisions_obstacle"], 0);
  EXPECT_GT(summary["deadline_miss_ratio"].get<double>(), 0.0) << "missed ticks are counted";
}

}  // namespace
}  // namespace swarm::test
