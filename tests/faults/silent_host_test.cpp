// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Hosts that join a run and then do not take part in it.
#include <string>

#include "swarm_launcher/hosts/line_socket.hpp"
#include "tests/system/flown_run.hpp"

namespace swarm::test {
namespace {

constexpr const char* kToken = "a-secret";

TEST(SilentHost, IsDroppedAndAnotherOneFliesItsRobots) {
  FlownRun run({"--remote", "4", "--join-token", kToken});
  const std::string address = join_address(run.launcher());
  ASSERT_NE(address, "") << run.outcome();
  auto hog = launcher::LineSocket::connect(*launcher::parse_host_port(address));
  ASSERT_TRUE(hog);
  hog->send(R"({"join":4,"token":"a-secret"})");
  ASSERT_TRUE(eventually([&] { return has_event(run.dir(), "host-joined"); }));

  ASSERT_TRUE(eventually([&] { return has_event(run.dir(), "host-absent"); }));
  TemporaryFolder theirs;
  Program host("swarm_launcher", {"join", address, "--robots", "4", "--join-token", kToken, "--out",
                                  (theirs.path() / "run").string()});

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_EQ(host.wait(), 0) << host.err();
  EXPECT_EQ(run.summary()["arrived"], 12);
}

TEST(SilentHost, IsRefusedWithoutTheToken) {
  FlownRun run({"--remote", "4", "--join-token", kToken});
  const std::string address = join_address(run.launcher());
  ASSERT_NE(address, "") << run.outcome();

  Program stranger("swarm_launcher", {"join", address, "--robots", "4"});

  EXPECT_NE(stranger.wait(), 0);
  EXPECT_NE(stranger.err().find("--join-token"), std::string::npos) << stranger.err();
  run.launcher().signal(SIGINT);
  run.launcher().wait();
}

}  // namespace
}  // namespace swarm::test
