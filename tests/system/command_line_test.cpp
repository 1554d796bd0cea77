// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The command line of every program: help, version, check, exit codes.
#include <csignal>
#include <fstream>

#include "flown_run.hpp"

namespace swarm::test {
namespace {

class EveryProgram : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryProgram, ReportsItsVersionAndHelp) {
  Program version(GetParam(), {"--version"});
  EXPECT_EQ(version.wait(), 0);
  EXPECT_NE(version.out().find(GetParam()), std::string::npos);

  Program help(GetParam(), {"--help"});
  EXPECT_EQ(help.wait(), 0);
  EXPECT_NE(help.out().find("--check"), std::string::npos);
}

TEST_P(EveryProgram, ChecksAMissionFile) {
  Program good(GetParam(), {"--check", kSmallMission});
  EXPECT_EQ(good.wait(), 0) << good.err();

  TemporaryFolder folder;
  const auto file = folder.path() / "bad.yaml";
  std::ofstream(file) << "version: 1\nrobots: {count: -3}\n";
  Program bad(GetParam(), {"--check", file.string()});
  EXPECT_EQ(bad.wait(), 3);
  EXPECT_NE(bad.err().find("bad.yaml:2:"), std::string::npos) << bad.err();
  EXPECT_TRUE(bad.out().empty());
}

TEST_P(EveryProgram, RefusesWrongUsage) {
  Program wrong(GetParam(), {"--no-such-option"});
  EXPECT_EQ(wrong.wait(), 3);
  EXPECT_FALSE(wrong.err().empty());

  Program nothing(GetParam(), {});
  EXPECT_EQ(nothing.wait(), 3);
}

INSTANTIATE_TEST_SUITE_P(CommandLine, EveryProgram,
                         ::testing::Values("planner_service", "robot_agent", "swarm_launcher",
                                           "swarm_monitor"));

TEST(Launcher, ReportsWhyAMissionCannotBePlanned) {
  // The goal lies behind a wall without a gap.
  TemporaryFolder folder;
  const auto file = folder.path() / "walled.yaml";
  std::ofstream(file) << R"(version: 1
world:
  bounds_m: [0, 0, 40, 30]
  obstacles: [{polygon_m: [[18, 0], [22, 0], [22, 30], [18, 30]]}]
robots: {count: 2}
start: [{mean_m: [8, 15], covariance_m2: [[2, 0], [0, 2]], weight: 1}]
goal: [{mean_m: [32, 15], covariance_m2: [[2, 0], [0, 2]], weight: 1}]
)";
  FlownRun run({}, file.string());

  EXPECT_EQ(run.launcher().wait(), 1);

  EXPECT_EQ(run.summary()["outcome"], "planner_failed");
  EXPECT_NE(run.launcher().err().find("planner_service:"), std::string::npos) << run.outcome();

  Program plan("swarm_launcher", {"plan", file.string()});
  EXPECT_EQ(plan.wait(), 1);
  EXPECT_FALSE(plan.err().empty());
}

TEST(Launcher, PlansWithoutFlying) {
  TemporaryFolder folder;
  Program plan("swarm_launcher",
               {"plan", kSmallMission, "--repeat", "3", "--json", "--out", folder.path().string()});

  ASSERT_EQ(plan.wait(), 0) << plan.err();

  const auto result = nlohmann::json::parse(plan.out());
  for (const char* key :
       {"nodes", "edges", "roadmap_ms", "search_ms", "transport_ms", "smoothing_ms", "total_ms",
        "planned_ratio", "max_cvar_m", "cost_m", "success"}) {
    EXPECT_TRUE(result[key].is_number()) << key;
  }
  EXPECT_EQ(result["success"], 1.0);
  EXPECT_LE(result["max_cvar_m"], -0.2 + 1e-3);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "plan.json"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "plan.svg"));
}

TEST(Launcher, RefusesADirectoryThatHoldsARun) {
  FlownRun run({"--robots", "2"});
  ASSERT_TRUE(run.mission_started());

  Program again("swarm_launcher", {"run", kSmallMission, "--out", run.dir().string()});

  EXPECT_EQ(again.wait(), 3);
  run.launcher().signal(SIGINT);
  run.launcher().wait();
}

TEST(Monitor, ReportsWhatIsNoRunDirectory) {
  TemporaryFolder folder;
  Program audit("swarm_monitor", {"audit", folder.path().string()});

  EXPECT_EQ(audit.wait(), 2);
  EXPECT_FALSE(audit.err().empty());

  for (const char* command : {"audit", "report", "view", "top", "record", "merge"}) {
    Program missing("swarm_monitor", {command, (folder.path() / "missing").string()});
    EXPECT_EQ(missing.wait(), 3) << command;
  }
}

TEST(Monitor, JoinsNoFinishedRun) {
  TemporaryFolder folder;
  std::ofstream(folder.path() / "summary.json") << "{}";

  for (const char* command : {"top", "record"}) {
    Program monitor("swarm_monitor", {command, folder.path().string()});
    EXPECT_EQ(monitor.wait(), 2) << command;
    EXPECT_NE(monitor.err().find("not in progress"), std::string::npos) << monitor.err();
  }
}

TEST(Launcher, NamesTheCommandsThatItKnows) {
  TemporaryFolder folder;
  Program command("swarm_launcher", {"command", folder.path().string(), "fly"});

  EXPECT_EQ(command.wait(), 3);
  EXPECT_NE(command.err().find("add_obstacle"), std::string::npos) << command.err();
}

}  // namespace
}  // namespace swarm::test
