// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A second planner joins a run: one leads, the other stands by and reports it.
#include <csignal>
#include <string>

#include "tests/system/flown_run.hpp"

namespace swarm::test {
namespace {

TEST(TwoPlanners, TheFirstLeadsAndTheSecondTakesOverWhenItIsFrozen) {
  FlownRun run({"--channel", "topics"});
  ASSERT_TRUE(run.mission_started()) << run.outcome();
  Program second("planner_service", {"--run", run.dir().string()});
  ASSERT_TRUE(eventually([&] { return has_event(run.dir(), "planner-standby"); }));
  EXPECT_FALSE(has_event(run.dir(), "planner-takeover")) << "the first one leads on";

  ASSERT_EQ(run.planners().size(), 1U);
  const pid_t first = run.planners().front();
  ::kill(first, SIGSTOP);
  EXPECT_TRUE(eventually([&] { return has_event(run.dir(), "planner-takeover"); }));
  ::kill(first, SIGCONT);

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  const auto summary = run.summary();
  EXPECT_EQ(summary["arrived"], 12);
  EXPECT_EQ(summary["collisions_robot"], 0);
  second.signal(SIGTERM);
  EXPECT_EQ(second.wait(), 0) << second.err();
}

// Each planner of a run on groups serves the robots' discovery at the same ports.
TEST(TwoPlanners, OnGroupsTheSecondIsRefused) {
  FlownRun run({"--channel", "groups"});
  ASSERT_TRUE(run.mission_started()) << run.outcome();

  Program second("planner_service", {"--run", run.dir().string()});

  EXPECT_NE(second.wait(), 0);
  EXPECT_FALSE(second.err().empty());
  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_EQ(run.summary()["arrived"], 12);
}

}  // namespace
}  // namespace swarm::test
