// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A mission from the file to the audited report, with real processes on real DDS.
#include <csignal>

#include "flown_run.hpp"

namespace swarm::test {
namespace {

TEST(Mission, FliesAndIsAudited) {
  FlownRun run;

  ASSERT_EQ(run.launcher().wait(), 0) << run.outcome();

  const auto summary = run.summary();
  EXPECT_EQ(summary["outcome"], "ok");
  EXPECT_EQ(summary["robots"], 12);
  EXPECT_EQ(summary["processes"], 12);
  EXPECT_EQ(summary["channel"], "topics");
  EXPECT_EQ(summary["arrived"], 12);
  EXPECT_TRUE(summary["lost"].empty());
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_EQ(summary["collisions_obstacle"], 0);
  EXPECT_GT(summary["min_robot_gap_m"], 0.0);
  EXPECT_GT(summary["min_obstacle_gap_m"], 0.0);
  EXPECT_GE(summary["path_ratio"], 1.0);
  EXPECT_LT(summary["path_ratio"], 1.3);
  EXPECT_TRUE(summary["refused_messages"].is_number());
  EXPECT_GE(summary["discovery_s"], 0.0);
  for (const char* key : {"mean_path_m", "geodesic_bound_m", "mission_s", "plan_ms",
                          "deadline_miss_ratio", "cpu_s", "max_rss_mb"}) {
    EXPECT_TRUE(summary[key].is_number()) << key;
  }
  for (const char* key : {"p50", "p99", "p999", "max"})
    EXPECT_TRUE(summary["state_age_ms"][key].is_number()) << key;
  for (const char* file :
       {"summary.json", "mission.resolved.yaml", "plan.json", "events.jsonl", "report.html",
        "paths.svg", "paths.png", "logs/planner.log", "blackbox/robot-00000.mcap"}) {
    EXPECT_TRUE(std::filesystem::exists(run.dir() / file)) << file;
  }
  EXPECT_EQ(nlohmann::json::parse(run.launcher().out()), summary);
}

// By default Cyclone numbers the participants of a machine up to ten only.
TEST(Mission, IsFlownByMoreCycloneProcessesThanItsDefaultsAllow) {
  FlownRun run({"--channel", "groups", "--dds", "cyclonedds"});

  ASSERT_EQ(run.launcher().wait(), 0) << run.outcome();

  const auto summary = run.summary();
  EXPECT_EQ(summary["processes"], 12);
  EXPECT_EQ(summary["arrived"], 12);
  EXPECT_EQ(summary["collisions_robot"], 0);
}

TEST(Mission, IsFlownWithRobotsOfAnotherMakeBehindAGateway) {
  FlownRun run({"--channel", "groups", "--by-gateway", "4"});
  std::vector<pid_t> gateways;
  ASSERT_TRUE(eventually([&] {
    gateways = children_of(run.launcher().pid(), "swarm_launcher");
    return gateways.size() == 1;
  })) << run.outcome();

  // A restarted gateway is discovered again: the mission starts only when every robot receives its
  // neighbours.
  ::kill(gateways[0], SIGKILL);

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_TRUE(has_event(run.dir(), "gateway-exit"));
  EXPECT_EQ(run.summary()["arrived"], 12);
  EXPECT_EQ(run.summary()["collisions_robot"], 0);
}

TEST(Mission, AuditOfItsDirectoryAgreesWithTheSummary) {
  FlownRun run({"--robots", "6"});
  ASSERT_EQ(run.launcher().wait(), 0) << run.outcome();

  Program audit("swarm_monitor", {"audit", run.dir().string(), "--json"});

  ASSERT_EQ(audit.wait(), 0) << audit.err();
  const auto audited = nlohmann::json::parse(audit.out());
  for (const char* key :
       {"arrived", "collisions_robot", "min_robot_gap_m", "mean_path_m", "path_ratio"}) {
    EXPECT_EQ(audited[key], run.summary()[key]) << key;
  }
}

TEST(Mission, PacksSeveralRobotsIntoAProcess) {
  FlownRun run({"--per-process", "5"});

  ASSERT_EQ(run.launcher().wait(), 0) << run.outcome();

  EXPECT_EQ(run.summary()["processes"], 3);
  EXPECT_EQ(run.summary()["arrived"], 12);
}

TEST(Mission, FliesOnMulticastGroups) {
  FlownRun run({"--channel", "groups"});

  ASSERT_EQ(run.launcher().wait(), 0) << run.outcome();

  EXPECT_EQ(run.summary()["channel"], "groups");
  EXPECT_EQ(run.summary()["arrived"], 12);
  EXPECT_EQ(run.summary()["collisions_robot"], 0);
}

TEST(Mission, TwoRunsAtOnceAreIsolated) {
  // Both use the same multicast addresses; their domains give them different ports.
  FlownRun one({"--robots", "6", "--seed", "1", "--channel", "groups"});
  FlownRun two({"--robots", "6", "--seed", "2", "--channel", "groups"});

  EXPECT_EQ(one.launcher().wait(), 0) << one.launcher().err();
  EXPECT_EQ(two.launcher().wait(), 0) << two.launcher().err();

  // Robots of both runs have the same ids: received ones would be refused as forged.
  for (const FlownRun* run : {&one, &two}) {
    EXPECT_EQ(read_text(run->dir() / "events.jsonl").find("message(s): forged"), std::string::npos);
  }
}

}  // namespace
}  // namespace swarm::test
