// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A gateway that is killed or frozen.
#include <csignal>
#include <set>

#include "tests/system/flown_run.hpp"

namespace swarm::test {
namespace {

TEST(KilledGateway, IsStartedAgainAndTheSwarmArrives) {
  FlownRun run({"--channel", "groups", "--by-gateway", "1"});
  ASSERT_TRUE(run.mission_started()) << run.outcome();
  std::set<pid_t> killed;
  for (int kills = 0; kills < 2; ++kills) {
    pid_t gateway = 0;
    ASSERT_TRUE(eventually([&] {
      const auto gateways = children_of(run.launcher().pid(), "swarm_launcher");
      gateway = gateways.empty() ? 0 : gateways.front();
      return gateway != 0 && !killed.contains(gateway);
    })) << kills;
    killed.insert(gateway);
    ::kill(gateway, SIGKILL);
  }

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_TRUE(has_event(run.dir(), "gateway-exit"));
  EXPECT_TRUE(has_event(run.dir(), "gateway-restarted"));
  EXPECT_EQ(run.summary()["arrived"], 12);
}

TEST(FrozenGateway, IsStartedAgainAndNoRobotsTouch) {
  FlownRun run({"--channel", "groups", "--by-gateway", "3"});
  ASSERT_TRUE(run.mission_started()) << run.outcome();
  const auto gateways = children_of(run.launcher().pid(), "swarm_launcher");
  ASSERT_EQ(gateways.size(), 1U);
  ::kill(gateways.front(), SIGSTOP);

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_TRUE(has_event(run.dir(), "gateway-silent"));
  EXPECT_TRUE(has_event(run.dir(), "gateway-restarted"));
  EXPECT_EQ(run.summary()["arrived"], 12);
  EXPECT_EQ(run.summary()["collisions_robot"], 0);
}

}  // namespace
}  // namespace swarm::test
