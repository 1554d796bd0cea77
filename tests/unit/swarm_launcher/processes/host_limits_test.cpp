// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/processes/host_limits.hpp"

#include <algorithm>

#include <gtest/gtest.h>
#include <sys/resource.h>

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

// At each limit exactly, and one below: the sizes are those that the messages name.
TEST(HostLimits, AreEnoughAtTheNeedAndNotOneBelow) {
  const struct {
    RunSize run;
    std::uint64_t files, threads;
  } cases[] = {{{.agents = 1}, 81, 204},
               {{.agents = 10, .robots_per_process = 100}, 180, 240},
               {{.agents = 10, .robots_per_process = 100, .relays = 7}, 192, 240},
               {{.agents = 1000, .robots_per_process = 1, .relays = 1}, 96, 4200}};
  for (const auto& c : cases) {
    EXPECT_TRUE(shortcomings({.open_files = c.files, .threads = c.threads}, c.run).empty());
    EXPECT_EQ(shortcomings({.open_files = c.files - 1, .threads = c.threads}, c.run).size(), 1U);
    EXPECT_EQ(shortcomings({.open_files = c.files, .threads = c.threads - 1}, c.run).size(), 1U);
    EXPECT_EQ(shortcomings({}, c.run).size(), 2U);
  }
}

TEST(HostLimits, AreNeverTooLowWhereThereAreNone) {
  const HostLimits unlimited{.open_files = RLIM_INFINITY, .threads = RLIM_INFINITY};
  constexpr std::uint32_t kMost = 20'000;
  EXPECT_TRUE(shortcomings(unlimited, {kMost, kMost, kMost}).empty());
}

TEST(OpenFiles, AreRaisedAsFarAsAllowedAndNeverLowered) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlim_t enough = std::min<rlim_t>(before.rlim_max, 65'536);

  for (const rlim_t soft : {rlim_t{64}, rlim_t{100}, enough, before.rlim_max}) {
    const rlimit limit{.rlim_cur = soft, .rlim_max = before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &limit), 0);
    raise_open_files();
    rlimit after{};
    ::getrlimit(RLIMIT_NOFILE, &after);
    EXPECT_EQ(after.rlim_cur, std::max(soft, enough));
    EXPECT_EQ(after.rlim_max, before.rlim_max);
    EXPECT_EQ(read_host_limits().open_files, after.rlim_cur);
  }
  ::setrlimit(RLIMIT_NOFILE, &before);
}

}  // namespace
}  // namespace swarm::launcher
