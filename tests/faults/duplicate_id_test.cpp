// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A second process for a robot that another process moves.
#include <filesystem>
#include <string>

#include "tests/system/flown_run.hpp"

namespace swarm::test {
namespace {

namespace fs = std::filesystem;

TEST(DuplicateId, IsRefusedInTheSameRunDirectory) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());

  Program second("robot_agent", {"--run", run.dir().string(), "--ids", "3"});

  EXPECT_EQ(second.wait(), 3) << "bad input";
  EXPECT_NE(second.err().find("another process moves robot 3"), std::string::npos) << second.err();
  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_EQ(run.summary()["collisions_robot"], 0);

  Program late("robot_agent", {"--run", run.dir().string(), "--ids", "3"});
  EXPECT_EQ(late.wait(), 3);
  EXPECT_NE(late.err().find("this run has ended"), std::string::npos) << late.err();
  Program planner("planner_service", {"--run", run.dir().string()});
  EXPECT_EQ(planner.wait(), 3);
  EXPECT_NE(planner.err().find("this run has ended"), std::string::npos) << planner.err();
}

// As from another host: the lock of the run directory cannot help.
TEST(DuplicateId, IsReportedByTheRobotWhoseIdItIs) {
  FlownRun run({"--channel", "topics"});
  ASSERT_TRUE(run.mission_started());
  const TemporaryFolder other;
  for (const char* file : {"run.json", "mission.resolved.yaml"}) {
    fs::copy_file(run.dir() / file, other.path() / file);
  }
  fs::create_directory(other.path() / "blackbox");
  {
    Program second("robot_agent", {"--run", other.path().string(), "--ids", "3", "--number", "15"});
    EXPECT_TRUE(eventually([&] { return has_event(run.dir(), "duplicate-id"); }));
  }
  run.launcher().wait();
  EXPECT_NE(run.launcher().err().find("receives states under an id of its own"), std::string::npos)
      << run.outcome();
}

}  // namespace
}  // namespace swarm::test
