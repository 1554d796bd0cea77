// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The planner and the agents of a run use DDS of different vendors.
#include <string>
#include <vector>

#include "tests/system/flown_run.hpp"

namespace swarm::test {
namespace {

class CrossedVendors : public testing::TestWithParam<const char*> {};

TEST_P(CrossedVendors, FlyTheSameMission) {
  FlownRun run({"--channel", "groups", "--dds", GetParam()});

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();

  const auto summary = run.summary();
  EXPECT_EQ(summary["arrived"], 12);
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_EQ(summary["collisions_obstacle"], 0);
}

INSTANTIATE_TEST_SUITE_P(Roles, CrossedVendors,
                         testing::Values("planner=cyclonedds", "agents=cyclonedds",
                                         "launcher=cyclonedds"));

}  // namespace
}  // namespace swarm::test
