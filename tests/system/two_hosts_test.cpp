// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Robots that another host starts. Both hosts are this machine here; tests/bench/two_hosts.sh gives
// each a network namespace of its own, and cuts the link.
#include <csignal>

#include "flown_run.hpp"

namespace swarm::test {
namespace {

TEST(TwoHosts, FlyOneMission) {
  FlownRun run({"--remote", "6"});
  const std::string address = join_address(run.launcher());
  ASSERT_NE(address, "") << run.outcome();
  TemporaryFolder theirs;
  Program first("swarm_launcher",
                {"join", address, "--robots", "4", "--out", (theirs.path() / "first").string()});
  Program second("swarm_launcher",
                 {"join", address, "--robots", "4", "--out", (theirs.path() / "second").string()});

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_EQ(first.wait(), 0) << first.err();
  EXPECT_EQ(second.wait(), 0) << second.err();
  const auto summary = run.summary();
  EXPECT_EQ(summary["arrived"], 12);  // by the robot logs, which were collected
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_EQ(summary["lost"], nlohmann::json::array());
}

TEST(TwoHosts, AHostThatGoesTakesItsRobotsWithIt) {
  FlownRun run({"--remote", "4"});
  const std::string address = join_address(run.launcher());
  ASSERT_NE(address, "") << run.outcome();
  TemporaryFolder theirs;
  Program host("swarm_launcher",
               {"join", address, "--robots", "4", "--out", (theirs.path() / "run").string()});
  ASSERT_TRUE(run.mission_started()) << run.outcome();
  const auto agents = children_of(host.pid(), "robot_agent");
  EXPECT_EQ(agents.size(), 4U);

  host.signal(SIGKILL);

  EXPECT_NE(run.launcher().wait(), 0);
  EXPECT_EQ(run.summary()["lost"], nlohmann::json({8, 9, 10, 11}));
  for (const pid_t agent : agents) EXPECT_NE(::kill(agent, 0), 0) << "an orphan";
}

TEST(TwoHosts, JoinFailsWithoutALauncher) {
  Program no_observer("swarm_launcher", {"join", "127.0.0.1:1", "--robots", "1"});

  EXPECT_NE(no_observer.wait(), 0);
  EXPECT_NE(no_observer.err().find("cannot connect to 127.0.0.1:1"), std::string::npos)
      << no_observer.err();
}

}  // namespace
}  // namespace swarm::test
