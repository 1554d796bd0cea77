// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/processes/host_limits.hpp"

#include <gtest/gtest.h>

namespace swarm::launcher {
namespace {

constexpr HostLimits kRoomy{.open_files = 1024, .threads = 100'000};

TEST(HostLimits, LeaveAUsualRunAlone) {
  EXPECT_TRUE(shortcomings(kRoomy, {.agents = 500, .relays = 20}).empty());
  EXPECT_GT(read_host_limits().open_files, 0U);
}

TEST(HostLimits, ReportWhichFallsShortAndHowToMendIt) {
  HostLimits limits = kRoomy;
  limits.open_files = 64;
  limits.threads = 500;
  limits.autogroup = true;
  const auto list = shortcomings(limits, {.agents = 300, .relays = 12});
  ASSERT_EQ(list.size(), 3U);
  EXPECT_NE(list[0].find("may open 64 files and needs about 272: run 'ulimit -n 544'"),
            std::string::npos)
      << list[0];
  EXPECT_NE(list[1].find("'ulimit -u 2800'"), std::string::npos) << list[1];
  EXPECT_NE(list[2].find("sched_autogroup_enabled=0"), std::string::npos) << list[2];
}

TEST(HostLimits, CountTheRobotsOfPackedProcesses) {
  EXPECT_EQ(shortcomings(kRoomy, {.agents = 4, .robots_per_process = 5000}).size(), 1U);
}

TEST(HostLimits, DoNotMentionPrioritiesInSmallRuns) {
  HostLimits limits = kRoomy;
  limits.autogroup = true;
  EXPECT_TRUE(shortcomings(limits, {.agents = 12}).empty());
}

}  // namespace
}  // namespace swarm::launcher
