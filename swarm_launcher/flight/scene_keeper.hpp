// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "swarmflow/mission/scene.hpp"
#include "swarm_link/port.hpp"

namespace swarm::launcher {

/// The scene of a run: whoever is asked to change it asks here. Publishes it and keeps its history.
class SceneKeeper {
 public:
  /// Publishes the scene of the mission file. \pre the world outlives the keeper
  SceneKeeper(const World& mission_world, const std::filesystem::path& run_dir,
              link::WriterPtr<link::SceneMessage> writer);

  /// Makes a change known to all; says what it was: "obstacle 6 added".
  Result<std::string> change(const SceneChange& change, UtcTime now);

  /// Makes several changes known at once. Returns why some of them were refused.
  std::vector<Error> change_all(std::span<const SceneChange> changes, UtcTime now);

  const Scene& scene() const { return scene_; }

 private:
  Result<void> make(const SceneChange& change, UtcTime now);

  const World& mission_world_;
  Scene scene_;
  std::ofstream log_;
  link::WriterPtr<link::SceneMessage> writer_;
};

}  // namespace swarm::launcher
