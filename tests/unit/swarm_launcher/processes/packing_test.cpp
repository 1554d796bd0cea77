// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/processes/packing.hpp"

#include <gtest/gtest.h>

namespace swarm::launcher {
namespace {

constexpr Machine kSmall{.cores = 2, .memory_mb = 24'000};

TEST(Packing, GivesEachRobotAProcessWhileTheMachineCarriesThem) {
  EXPECT_EQ(robots_per_process(1, kSmall), 1U);
  EXPECT_EQ(robots_per_process(400, kSmall), 1U);
  EXPECT_EQ(robots_per_process(1600, {.cores = 8, .memory_mb = 64'000}), 1U);
}

TEST(Packing, MakesTwoProcessesACoreOfMore) {
  EXPECT_EQ(robots_per_process(401, kSmall), 101U);
  EXPECT_EQ(robots_per_process(20'000, kSmall), 5000U);
}

TEST(Packing, HeedsLittleMemoryAndOddMachines) {
  EXPECT_EQ(robots_per_process(100, {.cores = 2, .memory_mb = 2'000}), 25U);
  EXPECT_EQ(robots_per_process(10, {.cores = 0, .memory_mb = 0}), 5U);
}

}  // namespace
}  // namespace swarm::launcher
