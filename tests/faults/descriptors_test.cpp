// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// An agent whose file descriptors are used up: it cannot join the groups of the cells around.
#include <chrono>
#include <thread>
#include <vector>

#include <sys/resource.h>

#include "flown_run.hpp"

namespace swarm::test {
namespace {

/// Sets the limit of open files of another process.
void limit_files(pid_t process, rlim_t files) {
  rlimit limit{};
  ASSERT_EQ(::prlimit(process, RLIMIT_NOFILE, nullptr, &limit), 0);
  limit.rlim_cur = files;
  ASSERT_EQ(::prlimit(process, RLIMIT_NOFILE, &limit, nullptr), 0);
}

TEST(Descriptors, ARobotThatCannotReceiveItsCellsStandsAndRecovers) {
  FlownRun run({"--channel", "groups"});
  ASSERT_TRUE(run.mission_started());
  const std::vector<pid_t> agents = run.agents();
  ASSERT_EQ(agents.size(), 12U);

  limit_files(agents[5], 3);  // open files stay open; no further one can be opened
  EXPECT_TRUE(eventually([&] { return has_event(run.dir(), "cells-missing"); }))
      << "the next cell cannot be joined";
  std::this_thread::sleep_for(std::chrono::seconds(3));
  limit_files(agents[5], 1024);

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_EQ(run.summary()["arrived"], 12);
  EXPECT_EQ(run.summary()["collisions_robot"], 0);
  EXPECT_TRUE(has_event(run.dir(), "moves-again"));
}

}  // namespace
}  // namespace swarm::test
