// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "swarm_link/messages.hpp"

namespace swarm::launcher {

/// Notices that robots follow a command or a scene that is newer than all that the launcher has
/// published: a forged one, or that of another launcher. Until their time has come, the launcher's
/// own would be out of date to the robots, so it publishes what holds again, under a newer number.
/// A pure class; not thread-safe.
class ForeignOrders {
 public:
  /// A status that passed the Gate. Those of stopped robots do not count: a stop of a user may not
  /// come from the launcher. Neither do command ids after `latest`, which robots refuse.
  void on_status(const link::StatusMessage& status, std::uint64_t latest) {
    scene_version_ = std::max(scene_version_, status.plan_scene_version);
    const auto has_stopped = [](const link::RobotStatusMessage& robot) {
      return robot.mode == RobotMode::kStopped;
    };
    if (std::ranges::any_of(status.robots, has_stopped)) return;
    if (status.command_id > latest) return;
    command_id_ = std::max(command_id_, status.command_id);
  }

  /// The newest number that robots follow, if it is newer than `published`, the launcher's newest.
  std::optional<std::uint64_t> command_after(std::uint64_t published) const {
    return command_id_ > published ? std::optional(command_id_) : std::nullopt;
  }
  std::optional<std::uint64_t> scene_after(std::uint64_t published) const {
    return scene_version_ > published ? std::optional(scene_version_) : std::nullopt;
  }

 private:
  std::uint64_t command_id_ = 0;
  std::uint64_t scene_version_ = 0;
};

}  // namespace swarm::launcher
