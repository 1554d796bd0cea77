// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// What surrounds a run: settings of other programs, ports of other programs, the terminal, and a
// launcher that is killed.
#include <csignal>
#include <cstdlib>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "flown_run.hpp"

namespace swarm::test {
namespace {

/// A variable of the environment, for the programs that are started meanwhile.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) { ::setenv(name, value, 1); }
  ~Variable() { ::unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

/// How programs that are started meanwhile find SIGHUP.
class Hangup {
 public:
  explicit Hangup(void (*action)(int)) : before_(std::signal(SIGHUP, action)) {}
  ~Hangup() { std::signal(SIGHUP, before_); }
  Hangup(const Hangup&) = delete;
  Hangup& operator=(const Hangup&) = delete;

 private:
  void (*before_)(int);
};

// Fast DDS would make every participant with simple discovery a client of that server.
TEST(Environment, OfRosChangesNothing) {
  const Variable server("ROS_DISCOVERY_SERVER", "127.0.0.1:11811");
  const Variable domain("ROS_DOMAIN_ID", "77");
  FlownRun run({"--channel", "groups"});
  ASSERT_TRUE(run.mission_started());
  EXPECT_TRUE(has_event(run.dir(), "settings-ignored"));
  ASSERT_FALSE(run.agents().empty());
  const std::string inherited = read_text(fmt::format("/proc/{}/environ", run.agents().front()));
  // Under another name drivers find it.
  EXPECT_EQ(inherited.find(std::string("\0ROS_DISCOVERY_SERVER=", 22)), std::string::npos);
  EXPECT_NE(inherited.find("SWARMFLOW_KEPT_ROS_DISCOVERY_SERVER="), std::string::npos);
  EXPECT_NE(inherited.find("ROS_DOMAIN_ID"), std::string::npos) << "a driver may use it";

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_NE(run.launcher().err().find("ROS_DISCOVERY_SERVER, ROS_DOMAIN_ID"), std::string::npos);
}

// The second participant's port: the planner's, by which all robots find it.
TEST(Environment, OfOtherDdsProgramsIsNamedWhereItTakesAPort) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  int domain = 225;  // high ones are rarely used
  for (;; --domain) {
    ASSERT_GT(domain, 100) << "all ports are in use";
    address.sin_port = htons(static_cast<std::uint16_t>(7410 + 250 * domain + 2));
    if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) break;
  }
  FlownRun run({"--channel", "groups", "--domain", std::to_string(domain)});

  EXPECT_EQ(run.launcher().wait(), 2);
  EXPECT_NE(run.launcher().err().find(fmt::format("UDP port {}", 7412 + 250 * domain)),
            std::string::npos)
      << run.outcome();
  ::close(fd);
}

TEST(Environment, EndsARunWithItsTerminal) {
  const Hangup usual(SIG_DFL);
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  const auto children = children_of(run.launcher().pid());

  run.launcher().signal(SIGHUP);  // by the kernel
  run.launcher().signal(SIGHUP);  // by the shell

  EXPECT_EQ(run.launcher().wait(), 1) << run.outcome();
  for (const Child& child : children) EXPECT_NE(::kill(child.pid, 0), 0) << child.program;
  EXPECT_EQ(run.summary()["outcome"], "interrupted");
}

TEST(Environment, OfNohupKeepsARunFlying) {
  const Hangup ignored(SIG_IGN);
  FlownRun run;
  ASSERT_TRUE(run.mission_started());

  run.launcher().signal(SIGHUP);

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
}

TEST(Environment, WithoutItsLauncherARunIsARecording) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  const auto children = children_of(run.launcher().pid());
  run.launcher().signal(SIGKILL);
  EXPECT_EQ(run.launcher().wait(), 128 + SIGKILL);
  for (const Child& child : children) {
    // Without a command line it may still be there, but only for its new parent to reap it.
    const std::string command_line = fmt::format("/proc/{}/cmdline", child.pid);
    EXPECT_TRUE(eventually([&] { return read_text(command_line).empty(); })) << child.program;
  }

  Program audit("swarm_monitor", {"audit", run.dir().string()});
  Program top("swarm_monitor", {"top", run.dir().string()});
  Program view("swarm_monitor", {"view", run.dir().string()});

  EXPECT_LE(audit.wait(), 1) << audit.err();
  EXPECT_EQ(top.wait(), 2) << top.out();
  EXPECT_TRUE(eventually([&] { return view.out().find("http://") != std::string::npos; }))
      << view.err();
  EXPECT_NE(view.err().find("its recording is shown"), std::string::npos) << view.err();
  view.signal(SIGTERM);
  EXPECT_EQ(view.wait(), 0);
}

}  // namespace
}  // namespace swarm::test
