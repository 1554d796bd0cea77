// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/system/program.hpp"

namespace swarm::test {

inline const std::string kSmallMission =
    std::string(SWARM_SOURCE_DIR) + "/deploy/missions/small.yaml";

/// The lines of a run's scene.jsonl.
inline std::vector<nlohmann::json> scene_changes(const std::filesystem::path& run_dir) {
  std::vector<nlohmann::json> changes;
  std::ifstream lines(run_dir / "scene.jsonl");
  for (std::string line; std::getline(lines, line);) {
    changes.push_back(nlohmann::json::parse(line, nullptr, false));
  }
  return changes;
}

/// Radius of the circle that a line of scene.jsonl adds.
inline double radius_m(const nlohmann::json& change) {
  const std::string keys = change["keys"];
  return std::stod(keys.substr(keys.find("radius: ") + 8));
}

/// The robots whose bodies became obstacles, with the radius of the first circle of each.
inline std::map<int, double> first_bodies(const std::filesystem::path& run_dir) {
  std::map<int, double> bodies;
  for (const nlohmann::json& change : scene_changes(run_dir)) {
    if (change["action"] != "add_body") continue;
    const std::string keys = change["keys"];
    bodies.emplace(std::stoi(keys.substr(keys.find("robot: ") + 7)), radius_m(change));
  }
  return bodies;
}

/// Of the small mission, where the last step of the robot is known: its radius, and half of what
/// its fastest command takes it on in two control periods.
constexpr double kLargestBody_m = 0.2 + 0.5 * 1.5 * 0.2 + 1e-9;

/// `swarm_launcher run` of the small mission in a folder of its own.
class FlownRun {
 public:
  explicit FlownRun(const std::vector<std::string>& more = {},
                    const std::string& mission = kSmallMission) {
    std::vector<std::string> arguments = {"run", mission, "--json", "--out", dir().string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    launcher_ = std::make_unique<Program>("swarm_launcher", arguments);
  }

  std::filesystem::path dir() const { return folder_.path() / "run"; }
  Program& launcher() { return *launcher_; }
  const Program& launcher() const { return *launcher_; }

  bool mission_started() const {
    return eventually([this] { return has_event(dir(), "command"); });
  }

  std::vector<pid_t> agents() const { return children_of(launcher_->pid(), "robot_agent"); }
  std::vector<pid_t> planners() const { return children_of(launcher_->pid(), "planner_service"); }

  /// For the message of a failed check: the summary's reasons, then what the launcher printed.
  std::string outcome() const {
    const nlohmann::json all = summary();
    return "reasons: " +
           (all.is_object() ? all.value("reasons", nlohmann::json()).dump() : "no summary") + "\n" +
           launcher_->err();
  }

  nlohmann::json summary() const {
    return nlohmann::json::parse(read_text(dir() / "summary.json"), nullptr, false);
  }

 private:
  TemporaryFolder folder_;
  std::unique_ptr<Program> launcher_;
};

/// Waits for the end of a flight of the small mission, in which no robot may be lost.
inline void expect_all_arrive(FlownRun& run) {
  EXPECT_EQ(run.launcher().wait(), 0) << run.outcome();
  EXPECT_EQ(run.summary()["arrived"], 12);
  EXPECT_EQ(run.summary()["collisions_robot"], 0);
}

}  // namespace swarm::test
