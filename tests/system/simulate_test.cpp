// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Lock-step missions and the papers' tables as programs.
#include <fstream>
#include <utility>

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
  EXPECT_GT(compared, 12U);  // a robot log each, the mission, plan and events
}

/// A mission of deploy/missions with other keys in its control section.
std::string with_control(const std::filesystem::path& folder, const std::string& name,
                         const std::string& keys) {
  std::string text = read_text(std::filesystem::path(SWARM_SOURCE_DIR) / "deploy/missions" / name);
  text += "\ncontrol: {" + keys + "}\n";
  const auto file = folder / name;
  std::ofstream(file) << text;
  return file.string();
}

TEST(Simulate, ASwarmThatIgnoresThePlansTimesFailsItsCriteria) {
  TemporaryFolder folder;
  const auto fly = [&](const std::string& tracking) {
    const std::string mission =
        with_control(folder.path(), "swarmprm_standin.yaml", "tracking: " + tracking);
    const std::string dir = (folder.path() / tracking).string();
    Program simulate("swarm_launcher", {"simulate", mission, "--out", dir, "--json"});
    const int code = simulate.wait();
    return std::pair(code, nlohmann::json::parse(simulate.out()));
  };

  const auto [kept, in_time] = fly("plan");
  EXPECT_EQ(kept, 0) << in_time["reasons"];
  EXPECT_LT(in_time["tracking"]["swarm"]["ratio"], 1.2);

  const auto [ignored, free] = fly("free");
  EXPECT_EQ(ignored, 1);
  EXPECT_EQ(free["arrived"], 100);  // by everything else it is a good flight
  EXPECT_EQ(free["collisions_robot"], 0);
  EXPECT_GT(free["tracking"]["swarm"]["ratio"], 3.0);
  EXPECT_NE(free["reasons"].dump().find("w2"), std::string::npos) << free["reasons"];
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
