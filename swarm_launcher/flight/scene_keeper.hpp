// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "swarm_launcher/supervision/event_log.hpp"
#include "swarm_link/port.hpp"
#include "swarmflow/mission/scene.hpp"

namespace swarm::launcher {

/// The scene of a run. All changes, of the user, the script or the supervisor, go through it: it
/// checks them, publishes the scene and logs its history.
class SceneKeeper {
 public:
  /// Publishes the scene of the mission file. The sink takes a line for each change. \pre the world
  /// outlives the keeper
  SceneKeeper(const World& mission_world, LineSink log, link::WriterPtr<link::SceneMessage> writer);

  /// Publishes a change and returns a description such as "obstacle 6 added".
  Result<std::string> change(const SceneChange& change, UtcTime now);

  /// Publishes several changes as one. Returns why some of them were refused.
  std::vector<Error> change_all(std::span<const SceneChange> changes, UtcTime now);

  /// Publishes the scene again, newer than a version that others have published: then what holds is
  /// in force again. `alpha`: the risk level of the mission file.
  void overrule(std::uint64_t foreign_version, double alpha, UtcTime now);

  const Scene& scene() const { return scene_; }

 private:
  /// Applies a change to the scene and logs it, without publishing.
  Result<void> make(const SceneChange& change, UtcTime now);

  const World& mission_world_;  ///< of the mission file
  Scene scene_;
  LineSink log_;
  link::WriterPtr<link::SceneMessage> writer_;
};

}  // namespace swarm::launcher
