// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Processes die (kill -9) in the middle of a mission.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include "flown_run.hpp"

namespace swarm::test {
namespace {

TEST(Loss, KilledRobotsAreNamedAndOthersAreNotDisturbed) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  const auto agents = run.agents();
  ASSERT_EQ(agents.size(), 12U);

  ::kill(agents[3], SIGKILL);
  ::kill(agents[8], SIGKILL);

  EXPECT_EQ(run.launcher().wait(), 1) << run.outcome();
  const auto summary = run.summary();
  EXPECT_EQ(summary["lost"], nlohmann::json({3, 8}));
  EXPECT_EQ(summary["arrived"], 10);
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_EQ(summary["collisions_obstacle"], 0);
}

std::size_t count(const std::vector<nlohmann::json>& changes, const std::string& action) {
  return static_cast<std::size_t>(std::count_if(
      changes.begin(), changes.end(), [&](const auto& c) { return c["action"] == action; }));
}

TEST(Loss, KilledRobotsLeaveBodiesThatCanBeCleared) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  const auto agents = run.agents();
  ASSERT_EQ(agents.size(), 12U);
  std::this_thread::sleep_for(std::chrono::seconds(5));  // they are under way

  for (const std::size_t i : {1U, 4U, 9U}) ::kill(agents[i], SIGKILL);
  ASSERT_TRUE(eventually([&] { return count(scene_changes(run.dir()), "add_body") == 3; }));
  Program clear("swarm_launcher", {"command", run.dir().string(), "clear", "4"});
  EXPECT_EQ(clear.wait(), 0) << clear.out();
  Program again("swarm_launcher", {"command", run.dir().string(), "clear", "4"});
  EXPECT_EQ(again.wait(), 1);
  EXPECT_NE(again.out().find("robot 4 has no body"), std::string::npos) << again.out();
  Program forged("swarm_launcher", {"command", run.dir().string(), "add_body",
                                    "robot: 2, circle_m: {center: [9, 9], radius: 1}"});
  EXPECT_EQ(forged.wait(), 1);

  EXPECT_EQ(run.launcher().wait(), 1) << run.outcome();
  const auto changes = scene_changes(run.dir());
  ASSERT_EQ(changes.size(), 4U);
  for (const std::size_t i : {0U, 1U, 2U}) {
    // The circle of a moving robot, from its last control period to where its driver stops it.
    EXPECT_GE(radius_m(changes[i]), 0.2) << changes[i];
    EXPECT_LE(radius_m(changes[i]), kLargestBody_m) << changes[i];
  }
  EXPECT_EQ(changes[3]["action"], "clear");
  EXPECT_EQ(changes[3]["keys"], "robot: 4");
  const auto summary = run.summary();
  EXPECT_EQ(summary["lost"], nlohmann::json({1, 4, 9}));
  EXPECT_EQ(summary["arrived"], 9);
  EXPECT_EQ(summary["collisions_robot"], 0);
  EXPECT_EQ(summary["collisions_obstacle"], 0);
}

TEST(Loss, TheBodyOfARespawnedRobotIsNoObstacleAnyMore) {
  TemporaryFolder folder;
  const std::filesystem::path mission = folder.path() / "respawning.yaml";
  std::string text = read_text(kSmallMission);
  text.replace(text.find("launcher:\n"), 10, "launcher:\n  respawn_agent_max: 1\n");
  std::ofstream(mission) << text;
  FlownRun run({}, mission.string());
  ASSERT_TRUE(run.mission_started());
  const auto agents = run.agents();
  ASSERT_EQ(agents.size(), 12U);
  std::this_thread::sleep_for(std::chrono::seconds(5));

  ::kill(agents[3], SIGKILL);
  ::kill(agents[8], SIGKILL);

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_EQ(first_bodies(run.dir()).size(), 2U);
  EXPECT_EQ(count(scene_changes(run.dir()), "clear"), 2U);
  EXPECT_TRUE(has_event(run.dir(), "body-cleared"));
  const auto summary = run.summary();
  EXPECT_EQ(summary["arrived"], 12);
  EXPECT_EQ(summary["collisions_robot"], 0);
}

// A directory in the place of the file fails as a full disk would, also for root.
TEST(Loss, ARestartedPlannerLeadsAlsoWithoutWritingItsFiles) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  const auto plan = run.dir() / "plan.json", saved = run.dir() / "saved.json";
  std::filesystem::rename(plan, saved);
  std::filesystem::create_directory(plan);

  ASSERT_EQ(run.planners().size(), 1U);
  ::kill(run.planners().front(), SIGKILL);

  EXPECT_TRUE(eventually([&] { return has_event(run.dir(), "disk-fails"); }));
  std::filesystem::remove_all(plan);
  std::filesystem::rename(saved, plan);
  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_EQ(run.summary()["arrived"], 12);
}

TEST(Loss, TheSwarmOutlivesItsPlanner) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  const auto planners = run.planners();
  ASSERT_EQ(planners.size(), 1U);

  ::kill(planners[0], SIGKILL);

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_TRUE(has_event(run.dir(), "respawn"));
  EXPECT_EQ(run.summary()["collisions_robot"], 0);
}

TEST(Loss, AFrozenPlannerMakesTheSwarmHoldAndItsReturnMakesItGoOn) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  const auto planners = run.planners();
  ASSERT_EQ(planners.size(), 1U);

  ::kill(planners[0], SIGSTOP);
  EXPECT_TRUE(eventually([&] { return has_event(run.dir(), "planner-silent"); }));
  ::kill(planners[0], SIGCONT);

  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
}

TEST(Loss, NoOrphansWhenTheLauncherIsKilled) {
  FlownRun run;
  ASSERT_TRUE(run.mission_started());
  auto processes = run.agents();
  for (const pid_t planner : run.planners()) processes.push_back(planner);
  ASSERT_EQ(processes.size(), 13U);

  run.launcher().signal(SIGKILL);
  run.launcher().wait();

  for (const pid_t pid : processes) {
    EXPECT_TRUE(eventually([&] {
      const std::string stat = read_text("/proc/" + std::to_string(pid) + "/stat");
      return stat.empty() || stat.find(") Z ") != std::string::npos;
    })) << pid;
  }
}

}  // namespace
}  // namespace swarm::test
