// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// A short soak: real processes, and a receiver that measures their states.
#include "flown_run.hpp"

namespace swarm::test {
namespace {

TEST(Soak, ReceivesEveryRobotWithoutLoss) {
  TemporaryFolder folder;
  const auto dir = folder.path() / "soak";
  Program soak("swarm_launcher", {"soak", "--processes", "6", "--per-process", "2", "--rate-hz",
                                  "20", "--duration-s", "6", "--channel", "groups", "--json",
                                  "--out", dir.string(), "--flat", "--max-late-pct", "100"});

  EXPECT_EQ(soak.wait(), 0) << soak.err() << soak.out();

  const auto result = nlohmann::json::parse(soak.out(), nullptr, false);
  EXPECT_EQ(result["outcome"], "ok");
  EXPECT_GE(result["received"], 12 * 6);  // at least twice a second, some of it before and after
  EXPECT_EQ(result["lost"], 0);
  EXPECT_EQ(result["collisions"], 0);
  EXPECT_GT(result["latency_ms"]["p50"], 0.0);
  EXPECT_GT(result["rss_mb"]["start"], 0.0);
  const auto& paths = result["paths"];
  EXPECT_GE(paths["commands"], 2) << "pause and resume";
  EXPECT_GE(paths["scenes"], 1);
  EXPECT_GT(paths["command_ms"]["p99"], 0.0);
  EXPECT_GT(paths["scene_to_plan_ms"]["p99"], 0.0);
  EXPECT_GT(paths["status_ms"]["p99"], 0.0);
  EXPECT_GT(paths["heartbeat_gap_ms"]["p50"], 0.0);
  EXPECT_TRUE(std::filesystem::exists(dir / "soak.html"));
}

TEST(Soak, FailsWhenItsCriteriaDo) {
  TemporaryFolder folder;
  Program soak("swarm_launcher",
               {"soak", "--processes", "2", "--duration-s", "5", "--channel", "topics",
                "--max-p99-ms", "1000", "--json", "--out", (folder.path() / "soak").string()});

  EXPECT_EQ(soak.wait(), 1) << soak.err();
  const auto result = nlohmann::json::parse(soak.out(), nullptr, false);
  EXPECT_EQ(result["reasons"][0], "the latency written → received is not known");
}

}  // namespace
}  // namespace swarm::test
