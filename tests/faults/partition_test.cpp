// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The cable between two hosts of a run is pulled in flight, and plugged in again. Needs root, for
// networks of its own.
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include <sys/wait.h>

#include "experiments/chaos/host_pair.hpp"
#include "tests/system/flown_run.hpp"

namespace swarm::test {
namespace {

using launcher::HostPair;

/// Exit code of a child; -1 at the end of the time limit.
int exit_code_of(pid_t pid) {
  int status = 0;
  const bool ended = eventually([&] { return ::waitpid(pid, &status, WNOHANG) == pid; },
                                std::chrono::seconds(240));
  return ended && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(Partition, OfTwoHostsIsReportedAndAfterItAllArrive) {
  const auto hosts = HostPair::make();
  if (!hosts) GTEST_SKIP() << hosts.error().message;
  const TemporaryFolder folder;
  const auto dir = folder.path() / "run", log = folder.path() / "log";
  const std::string program = std::string(SWARM_BIN_DIR) + "/swarm_launcher";
  const auto first = (*hosts)->start(
      HostPair::Host::kFirst,
      {program, "run", kSmallMission, "--out", dir.string(), "--remote", "6", "--join-port", "7000",
       "--interface", HostPair::address(HostPair::Host::kFirst)},
      log);
  ASSERT_TRUE(first) << first.error().message;
  ASSERT_TRUE(
      eventually([&] { return read_text(log).find("swarm_launcher join") != std::string::npos; }));
  const auto second =
      (*hosts)->start(HostPair::Host::kSecond,
                      {program, "join", HostPair::address(HostPair::Host::kFirst) + ":7000",
                       "--robots", "6", "--out", (folder.path() / "joined").string()},
                      folder.path() / "joined.log");
  ASSERT_TRUE(second) << second.error().message;
  ASSERT_TRUE(eventually([&] { return has_event(dir, "command"); })) << read_text(log);
  std::this_thread::sleep_for(std::chrono::seconds(5));  // they are under way

  ASSERT_TRUE((*hosts)->pull_cable());
  EXPECT_TRUE(eventually([&] { return has_event(dir, "host-silent"); }));
  std::this_thread::sleep_for(std::chrono::seconds(2));
  (*hosts)->plug_cable();

  EXPECT_EQ(exit_code_of(*first), 0) << read_text(log);
  EXPECT_EQ(exit_code_of(*second), 0) << read_text(folder.path() / "joined.log");
  EXPECT_TRUE(has_event(dir, "host-back"));
  const auto summary = nlohmann::json::parse(read_text(dir / "summary.json"), nullptr, false);
  EXPECT_EQ(summary["arrived"], 12);
  EXPECT_EQ(summary["lost"], nlohmann::json::array());
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_EQ(summary["collisions_obstacle"], 0);
}

}  // namespace
}  // namespace swarm::test
