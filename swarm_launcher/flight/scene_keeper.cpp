// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/scene_keeper.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/base/assert.hpp"
#include "swarm_core/mission_file/scene_log.hpp"
#include "swarm_link/to_message.hpp"

namespace swarm::launcher {

// The first scene is published, too, so that every reader knows the current version.
SceneKeeper::SceneKeeper(const World& mission_world, LineSink log,
                         link::WriterPtr<link::SceneMessage> writer)
    : mission_world_(mission_world),
      scene_(first_scene(mission_world.obstacles().size())),
      log_(std::move(log)),
      writer_(std::move(writer)) {
  writer_->write(link::to_message(scene_));
}

// Logged at once, so that a monitor or an audit sees every published version.
Result<void> SceneKeeper::make(const SceneChange& change, UtcTime now) {
  auto next = after(scene_, change, mission_world_, now);
  if (!next) return tl::unexpected(next.error());
  scene_ = std::move(*next);
  log_(scene_log_line(scene_.version, change));
  return {};
}

Result<std::string> SceneKeeper::change(const SceneChange& change, UtcTime now) {
  const std::uint32_t next_id = scene_.next_id;
  if (auto made = make(change, now); !made) return tl::unexpected(made.error());
  writer_->write(link::to_message(scene_));
  return scene_.next_id > next_id ? fmt::format("obstacle {} added", next_id)
                                  : std::string(name_of(change));
}

// In the log as a change, as audits look for every version that robots have received.
void SceneKeeper::overrule(std::uint64_t foreign_version, double alpha, UtcTime now) {
  scene_.version = std::max(scene_.version, foreign_version);
  const auto published = change(SetRisk{scene_.risk_alpha.value_or(alpha)}, now);
  SWARM_ASSERT(published.has_value());
}

// One message for all changes: every published scene causes a new plan.
std::vector<Error> SceneKeeper::change_all(std::span<const SceneChange> changes, UtcTime now) {
  std::vector<Error> refused;
  for (const SceneChange& change : changes) {
    if (auto made = make(change, now); !made) refused.push_back(made.error());
  }
  if (refused.size() < changes.size()) writer_->write(link::to_message(scene_));
  return refused;
}

}  // namespace swarm::launcher
