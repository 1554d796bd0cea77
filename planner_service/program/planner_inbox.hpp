// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "swarm_link/gate/gate.hpp"
#include "swarm_link/port.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/phase.hpp"
#include "swarmflow/mission/scene.hpp"

namespace swarm::planner {

/// Readers of the topics that a planner subscribes to.
struct Readers {
  link::ReaderPtr<link::CommandMessage> command;
  link::ReaderPtr<link::SceneMessage> scene;
  link::ReaderPtr<link::StatusMessage> status;
  link::ReaderPtr<link::HeartbeatMessage> heartbeat;
};

/// The messages that the planner receives: takes all that arrived, validates them at the gate, and
/// hands on the valid ones. Not thread-safe.
class PlannerInbox {
 public:
  PlannerInbox(Readers readers, const link::WireLimits& limits);

  void receive(UtcTime now);

  /// Moved by the commands received so far.
  MissionPhase phase() const { return phase_; }
  /// Stamp of the command that started the mission, 0 before. The launcher keeps its commands for
  /// late joiners, so a restarted planner finds it again.
  std::int64_t t0_utc_ns() const { return t0_utc_ns_; }
  /// Of the last receive(), each newer than the one before.
  std::span<Scene> scenes() { return new_scenes_; }
  /// Of the last receive(); robot ids are those of the mission, each from its own sender.
  std::span<const link::StatusMessage> statuses() const { return statuses_; }
  /// Of the last receive(), of all planners, this one included.
  std::span<const link::HeartbeatMessage> heartbeats() const { return heartbeats_; }

  const link::RefusalCounters& refused() const { return gate_.refused(); }

 private:
  void apply(const link::CommandMessage& command);
  void receive_statuses(UtcTime now);

  Readers readers_;
  link::Gate gate_;
  MissionPhase phase_ = MissionPhase::kReady;
  std::int64_t t0_utc_ns_ = 0;
  std::vector<Scene> new_scenes_;
  std::vector<link::CommandMessage> commands_;
  std::vector<link::SceneMessage> scenes_;
  std::vector<link::StatusMessage> statuses_;
  std::vector<std::uint64_t> senders_;
  std::vector<link::HeartbeatMessage> heartbeats_;
};

}  // namespace swarm::planner
