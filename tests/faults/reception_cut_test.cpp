// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Some robots receive nothing for a while, and the others still receive them.
#include "tests/system/flown_run.hpp"

namespace swarm::test {
namespace {

class ReceptionCut : public testing::TestWithParam<const char*> {};

// Three of them hold, since they do not receive the planner, and fly on afterwards.
TEST_P(ReceptionCut, OfThreeRobotsEndsWithoutContact) {
  FlownRun run({"--channel", GetParam(), "--fault", "loss=1,robots=3-5,from=10,to=16"});

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();

  EXPECT_TRUE(has_event(run.dir(), "planner-silent"));
  const auto summary = run.summary();
  EXPECT_EQ(summary["arrived"], 12);
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_EQ(summary["collisions_obstacle"], 0);
}

// Duplicates change nothing, also for the launcher.
TEST_P(ReceptionCut, DuplicatesAreHarmless) {
  FlownRun run(
      {"--channel", GetParam(), "--fault", "duplicate=0.5,delay-ms=20,jitter-ms=20,launcher=1"});

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();

  EXPECT_EQ(run.summary()["arrived"], 12);
  EXPECT_EQ(run.summary()["collisions_robot"], 0);
}

INSTANTIATE_TEST_SUITE_P(Channels, ReceptionCut, testing::Values("topics", "groups"));

}  // namespace
}  // namespace swarm::test
