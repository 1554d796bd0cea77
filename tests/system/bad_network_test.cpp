// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// State updates are lost and delayed, and so are the messages of a new planner.
#include <csignal>

#include "flown_run.hpp"

namespace swarm::test {
namespace {

TEST(BadNetwork, IsFlownThrough) {
  FlownRun run({"--channel", "groups", "--fault", "loss=0.2,delay-ms=150,jitter-ms=50"});
  ASSERT_TRUE(run.mission_started()) << run.outcome();
  const auto planners = run.planners();
  ASSERT_EQ(planners.size(), 1U);

  ::kill(planners[0], SIGKILL);

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  const auto summary = run.summary();
  EXPECT_EQ(summary["arrived"], 12);
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_EQ(summary["collisions_obstacle"], 0);
  EXPECT_GE(summary["state_age_ms"]["p50"], 150.0);
  EXPECT_GT(summary["belief_error_cm"]["max"], 0.0);
}

TEST(BadNetwork, RefusesAnInvalidDescription) {
  FlownRun run({"--fault", "loss=2"});

  EXPECT_EQ(run.launcher().wait(), 3);
  EXPECT_NE(run.launcher().err().find("'loss=2' is not in 0 to 1"), std::string::npos)
      << run.outcome();
}

}  // namespace
}  // namespace swarm::test
