// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// What an observer of a simulation receives, in which order and on which thread.
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>

#include "swarm_sim/simulation.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

Mission scripted_mission() {
  auto mission =
      load_mission(std::filesystem::path(SWARM_SOURCE_DIR) / "deploy/missions/small.yaml");
  EXPECT_TRUE(mission.has_value());
  mission->robots.count = 6;
  mission->script = {{.at_s = 1.0, .action = SceneChange(SetRisk{.alpha = 0.2})},
                     {.at_s = 3.0, .action = SceneChange(GoTo{.goal = mission->start})},
                     {.at_s = 5.0, .action = CommandKind::kStop}};
  return *std::move(mission);
}

class Witness final : public SimulationObserver {
 public:
  void on_event(UtcTime at, const std::string&, bool, const std::string& code,
                const std::string& text) override {
    saw_thread();
    EXPECT_GE(at, newest) << code;
    EXPECT_FALSE(code.empty());
    EXPECT_EQ(text.find('\n'), std::string::npos) << "one line: " << text;
    newest = at;
  }
  void on_plan(std::uint32_t version, const planner::PlanResult& planned) override {
    saw_thread();
    versions.push_back(version);
    EXPECT_FALSE(planned.plan.empty());
  }
  void on_clock(const PlanClock& reading) override {
    saw_thread();
    // A reading belongs to the plan that was published last.
    ASSERT_FALSE(versions.empty());
    EXPECT_EQ(reading.plan_version, versions.back());
    EXPECT_GE(reading.rate, 0.0);
    EXPECT_LE(reading.rate, 1.0);
    ++readings;
  }
  void on_scene(const Scene& scene, const SceneChange& change) override {
    saw_thread();
    EXPECT_TRUE(scenes.empty() || scene.version > scenes.back());
    scenes.push_back(scene.version);
    changes.emplace_back(name_of(change));
    if (std::holds_alternative<SetRisk>(change)) {
      EXPECT_EQ(scene.risk_alpha, 0.2) << "the scene after the change";
    }
    if (std::holds_alternative<GoTo>(change)) {
      EXPECT_TRUE(scene.goal.has_value());
    }
  }

  std::vector<std::uint32_t> versions;
  std::vector<std::uint64_t> scenes;
  std::vector<std::string> changes;
  int readings = 0;
  UtcTime newest = Simulation::begin_utc();

 private:
  void saw_thread() const { EXPECT_EQ(std::this_thread::get_id(), caller_); }
  std::thread::id caller_ = std::this_thread::get_id();
};

TEST(SimulationObserver, ReceivesPlansClocksAndScenesInOrderOnTheCallersThread) {
  const Mission mission = scripted_mission();
  Recording recording(mission, Simulation::begin_utc(), 1);
  Witness witness;
  auto simulation = Simulation::make(mission, {.threads = 3}, recording, witness);
  ASSERT_TRUE(simulation.has_value()) << simulation.error().message;

  while ((*simulation)->step()) {
  }

  EXPECT_EQ((*simulation)->outcome(), Outcome::kStopped);
  ASSERT_GE(witness.versions.size(), 2U);
  for (std::size_t i = 0; i < witness.versions.size(); ++i) {
    EXPECT_EQ(witness.versions[i], i + 1) << "versions ascend from 1";
  }
  EXPECT_EQ(witness.changes, (std::vector<std::string>{"risk", "goto"}));
  EXPECT_GT(witness.readings, 0);
}

TEST(Simulation, EndsEarlyWhenInterrupted) {
  const Mission mission = scripted_mission();
  Recording recording(mission, Simulation::begin_utc(), 1);
  SimulationObserver no_observer;
  auto simulation = Simulation::make(mission, {}, recording, no_observer);
  ASSERT_TRUE(simulation.has_value());
  while ((*simulation)->mission_s() < 0.5) ASSERT_TRUE((*simulation)->step());

  (*simulation)->interrupt();
  int periods = 0;
  while ((*simulation)->step()) ASSERT_LT(++periods, 1000) << "it does not end";

  EXPECT_EQ((*simulation)->outcome(), Outcome::kInterrupted);
  EXPECT_LT((*simulation)->mission_s(), 5.0) << "before the script's stop";
}

TEST(Simulation, RefusesAMissionThatCannotBePlanned) {
  Mission mission = scripted_mission();
  const Box box = mission.world.convex_obstacles().at(0).box;
  const Vec2 inside_m = 0.5 * (box.min_m + box.max_m);
  mission.goal = Mixture::make({{1.0, Gaussian::from_parameters(inside_m, 1, 1, 0)}}).value();
  Recording recording(mission, Simulation::begin_utc(), 1);
  SimulationObserver no_observer;

  const auto simulation = Simulation::make(mission, {}, recording, no_observer);

  ASSERT_FALSE(simulation.has_value());
  EXPECT_EQ(simulation.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(simulation.error().message.find("goal component 0"), std::string::npos);
}

TEST(UsefulThreads, AreOneForFewRobotsAndNeverFewerForMore) {
  EXPECT_EQ(useful_threads(1), 1U);
  std::size_t before = 1;
  for (std::uint32_t robots = 1; robots < 100'000; robots *= 2) {
    EXPECT_GE(useful_threads(robots), before);
    before = useful_threads(robots);
  }
}

}  // namespace
}  // namespace swarm::launcher
