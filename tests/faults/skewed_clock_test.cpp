// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A host whose wall clock differs from that of the launcher's host.
#include <string>

#include "experiments/chaos/stepped_clock.hpp"
#include "tests/system/flown_run.hpp"

namespace swarm::test {
namespace {

// By more than any limit of a message's age: stamps are of the run's clock, which the launcher
// gives.
TEST(SkewedClock, OfAHostThatJoinsChangesNothing) {
  const TemporaryFolder theirs;
  FlownRun run({"--remote", "6"});
  const std::string address = join_address(run.launcher());
  ASSERT_NE(address, "") << run.outcome();
  const auto clock = launcher::SteppedClock::make(theirs.path() / "offset");
  if (!clock) GTEST_SKIP() << clock.error().message;
  (*clock)->step(-20);

  Program host("swarm_launcher",
               {"join", address, "--robots", "6", "--out", (theirs.path() / "run").string()});

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_EQ(host.wait(), 0) << host.err();
  const auto summary = run.summary();
  EXPECT_EQ(summary["arrived"], 12);
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_EQ(summary["collisions_obstacle"], 0);
}

}  // namespace
}  // namespace swarm::test
