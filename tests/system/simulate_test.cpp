// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Lock-step missions and the papers' tables as programs.
#include <nlohmann/json.hpp>

#include "flown_run.hpp"

namespace swarm::test {
namespace {

TEST(Simulate, LeavesARunThatIsAuditedLikeAnyOther) {
  TemporaryFolder folder;
  const std::string dir = (folder.path() / "run").string();

  Program simulate("swarm_launcher", {"simulate", kSmallMission, "--out", dir, "--json"});
  ASSERT_EQ(simulate.wait(), 0) << simulate.err();
  Program audit("swarm_monitor", {"audit", dir, "--json"});
  ASSERT_EQ(audit.wait(), 0) << audit.err();

  const auto summary = nlohmann::json::parse(simulate.out());
  const auto audited = nlohmann::json::parse(audit.out());
  EXPECT_EQ(summary["outcome"], "ok");
  EXPECT_EQ(summary["channel"], "lock-step");
  for (const char* key : {"arrived", "path_ratio", "min_robot_gap_m", "mission_s"}) {
    EXPECT_EQ(summary[key], audited[key]) << key;
  }
}

TEST(Simulate, GivesTheSameBytesOnAnyNumberOfThreads) {
  TemporaryFolder folder;
  const auto fly = [&](const std::string& threads) {
    const auto dir = folder.path() / threads;
    Program simulate("swarm_launcher", {"simulate", kSmallMission, "--seed", "7", "--fault",
                                        "loss=0.2", "--threads", threads, "--out", dir.string()});
    EXPECT_EQ(simulate.wait(), 0) << simulate.err();
    return dir;
  };
  const auto one = fly("1");
  const auto three = fly("3");

  std::size_t compared = 0;
  for (const auto& file : std::filesystem::recursive_directory_iterator(one)) {
    // Wall times differ, and the report has them.
    const auto name = file.path().filename();
    if (!file.is_regular_file() || name == "summary.json" || name == "report.html") continue;
    const auto relative = std::filesystem::relative(file.path(), one);
    EXPECT_EQ(read_text(file.path()), read_text(three / relative)) << relative;
    ++compared;
  }
  EXPECT_GT(compared, 12U);  // a black box each, the mission, plan and events
}

class EveryTable : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryTable, IsMadeQuickly) {
  const std::string which = GetParam();
  TemporaryFolder folder;

  Program table("swarm_launcher",
                {"table", which, "--quick", "--missions", SWARM_SOURCE_DIR "/deploy/missions",
                 "--out", folder.path().string()});
  ASSERT_EQ(table.wait(), 0) << table.err();

  EXPECT_EQ(read_text(folder.path() / (which + ".md")), table.out());
  const auto rows = nlohmann::json::parse(read_text(folder.path() / (which + ".json")));
  ASSERT_FALSE(rows.empty());
  EXPECT_GT(rows[0]["seeds"][0]["mission_s"], 0.0);
  EXPECT_NE(read_text(folder.path() / (which + "-00.svg")).find("</svg>"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Table, EveryTable,
                         ::testing::Values("swarmprm", "rover", "crops", "diffusion", "network"));

}  // namespace
}  // namespace swarm::test
