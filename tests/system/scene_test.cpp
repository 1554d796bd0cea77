// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The map and the goal change while the swarm flies.
#include <csignal>
#include <fstream>

#include "flown_run.hpp"

namespace swarm::test {
namespace {

const std::string kChanging = std::string(SWARM_SOURCE_DIR) + "/deploy/missions/changing.yaml";

/// Texts of all events with a code.
std::vector<std::string> reported(const std::filesystem::path& run_dir, const std::string& code) {
  std::vector<std::string> texts;
  std::ifstream events(run_dir / "events.jsonl");
  for (std::string line; std::getline(events, line);) {
    const auto event = nlohmann::json::parse(line, nullptr, false);
    if (event.is_object() && event["code"] == code) texts.push_back(event["text"]);
  }
  return texts;
}

void expect_good(const nlohmann::json& summary, int robots) {
  EXPECT_EQ(summary["outcome"], "ok") << summary.dump();
  EXPECT_EQ(summary["arrived"], robots);
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_EQ(summary["collisions_obstacle"], 0);
}

TEST(Scene, ChangesByScriptAndTheSwarmFollows) {
  FlownRun run({}, kChanging);

  ASSERT_EQ(run.launcher().wait(), 0) << run.outcome();

  expect_good(run.summary(), 12);
  // Robots per component of the new goal: 3 and 9 by its weights, within two.
  ASSERT_EQ(run.summary()["arrived_per_goal"].size(), 2U);
  EXPECT_NEAR(run.summary()["arrived_per_goal"][0].get<double>(), 3.0, 2.0);
  EXPECT_EQ(reported(run.dir(), "scene").size(), 4U);
  EXPECT_TRUE(reported(run.dir(), "replan-failed").empty());
  // A plan for the start and one for each change; more while the obstacle moves.
  EXPECT_GE(reported(run.dir(), "planned").size(), 5U);
}

TEST(Scene, ChangesByCommandAndReportsWhatItMadeOfIt) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  const auto command = [&](const std::vector<std::string>& command_line) {
    std::vector<std::string> arguments{"command", run.dir().string()};
    arguments.insert(arguments.end(), command_line.begin(), command_line.end());
    Program program("swarm_launcher", arguments);
    const int code = program.wait();
    return std::pair(code, program.out());
  };

  EXPECT_EQ(command({"add_obstacle", "circle_m: {center: [20, 15], radius: 0.8}"}),
            std::pair(0, std::string("done: obstacle 2 added\n")));
  EXPECT_EQ(command({"remove_obstacle", "obstacle: 1"}).first, 0);
  const auto [refused, why] = command({"move_obstacle", "obstacle: 1, by_m: [1, 1]"});
  EXPECT_EQ(refused, 1);
  EXPECT_NE(why.find("there is no obstacle 1"), std::string::npos) << why;
  EXPECT_NE(command({"risk", "alpha: 7"}).second.find("alpha is 7; must be"), std::string::npos);
  EXPECT_EQ(command({"jump"}).first, 3) << "no such command";

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  expect_good(run.summary(), 12);
}

TEST(Scene, OutlivesThePlanner) {
  FlownRun run({}, kChanging);
  ASSERT_TRUE(run.mission_started());
  ASSERT_TRUE(eventually([&] { return !reported(run.dir(), "scene").empty(); }));

  ::kill(run.planners().at(0), SIGKILL);

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_TRUE(has_event(run.dir(), "respawn"));
  expect_good(run.summary(), 12);
}

TEST(Scene, ThatCannotBePlannedKeepsTheLastPlan) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());

  // On the mean of goal 1: no plan can keep its risk limit there.
  Program program("swarm_launcher", {"command", run.dir().string(), "add_obstacle",
                                     "circle_m: {center: [33, 9], radius: 0.3}"});
  ASSERT_EQ(program.wait(), 0) << program.out();

  EXPECT_TRUE(eventually([&] { return !reported(run.dir(), "replan-failed").empty(); }));
  EXPECT_NE(reported(run.dir(), "replan-failed").front().find("goal component 1"),
            std::string::npos);
  run.launcher().wait();
  EXPECT_EQ(run.summary()["collisions_obstacle"], 0);
  EXPECT_EQ(run.summary()["collisions_robot"], 0);
}

}  // namespace
}  // namespace swarm::test
