// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Faults of all kinds at random times: `swarm_launcher chaos`.
#include <csignal>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <unistd.h>

#include "tests/system/flown_run.hpp"

namespace swarm::test {
namespace {

/// `swarm_launcher chaos`: one flight of six robots.
std::vector<std::string> chaos(const std::filesystem::path& out, const char* seed) {
  return {"chaos",  kSmallMission, "--robots", "6",          "--minutes", "0",
          "--seed", seed,          "--out",    out.string(), "--json"};
}

std::set<std::string> names_in(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.insert(entry.path().filename());
  }
  return names;
}

TEST(Chaos, FliesThroughAllFaultsOfASeed) {
  const TemporaryFolder folder;
  const auto out = folder.path() / "chaos";
  Program program("swarm_launcher", chaos(out, "1"));

  EXPECT_EQ(program.wait(), 0) << program.err() << program.out();

  const auto result = nlohmann::json::parse(program.out(), nullptr, false);
  EXPECT_EQ(result["verdict"], "ok") << program.out();
  EXPECT_EQ(result["flights"], 1);
  EXPECT_EQ(result["contacts"], 0);
  EXPECT_GE(result["faults"].size(), 3U) << "kinds";
  if (::geteuid() != 0) {
    EXPECT_TRUE(result["left_out"].contains("fill-disk")) << "it needs root";
  }
  const auto names = names_in(out);
  EXPECT_TRUE(names.contains("flight-0001.chaos.jsonl"));
  EXPECT_FALSE(names.contains("logs")) << "it is no run directory";
  EXPECT_FALSE(names.contains("blackbox"));
}

TEST(Chaos, LeavesNoProcessBehindWhenItIsInterrupted) {
  const TemporaryFolder folder;
  const auto out = folder.path() / "chaos";
  Program program("swarm_launcher", chaos(out, "1"));
  std::vector<Child> children;
  ASSERT_TRUE(eventually([&] {
    children = children_of(program.pid());
    if (children.empty()) return false;
    for (const Child& child : children_of(children.front().pid)) children.push_back(child);
    return children.size() >= 8;
  })) << "the launcher of the flight, its planner and six agents";

  program.signal(SIGINT);

  EXPECT_EQ(program.wait(), 0) << program.err();
  for (const Child& child : children) {
    // A child whose parent has ended is reaped by another process.
    EXPECT_TRUE(eventually([&] { return ::kill(child.pid, 0) != 0; }, std::chrono::seconds(20)))
        << child.program << " " << child.pid;
  }
  EXPECT_TRUE(nlohmann::json::parse(program.out(), nullptr, false)["interrupted"]);
}

}  // namespace
}  // namespace swarm::test
