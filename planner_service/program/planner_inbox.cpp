// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/program/planner_inbox.hpp"

#include <utility>

namespace swarm::planner {

PlannerInbox::PlannerInbox(Readers readers, const link::WireLimits& limits)
    : readers_(std::move(readers)), gate_({.limits = limits}) {}

// Commands first: phase and t0 are those after all commands that arrived. Messages that the gate
// refuses are counted and dropped.
void PlannerInbox::receive(UtcTime now) {
  commands_.clear();
  readers_.command->take(commands_);
  for (const link::CommandMessage& command : commands_) {
    if (gate_.command(command, now)) apply(command);
  }
  scenes_.clear();
  new_scenes_.clear();
  readers_.scene->take(scenes_);
  for (const link::SceneMessage& message : scenes_) {
    if (auto scene = gate_.scene(message, now)) new_scenes_.push_back(std::move(*scene));
  }
  receive_statuses(now);
  heartbeats_.clear();
  readers_.heartbeat->take(heartbeats_);
  std::erase_if(heartbeats_, [&](const link::HeartbeatMessage& beat) {
    return !gate_.any_heartbeat(beat, now);
  });
  gate_.set_undecodable(readers_.command->undecodable() + readers_.scene->undecodable() +
                        readers_.status->undecodable() + readers_.heartbeat->undecodable());
}

// A robot whose body is an obstacle has died or is silent: its next process has another sender.
void PlannerInbox::receive_statuses(UtcTime now) {
  for (const Scene& scene : new_scenes_) {
    for (const SceneObstacle& obstacle : scene.obstacles) {
      if (obstacle.owner) gate_.release_status(*obstacle.owner, now);
    }
  }
  statuses_.clear();
  senders_.clear();
  readers_.status->take_with_senders(statuses_, senders_);
  std::size_t next = 0;
  std::erase_if(statuses_, [&](const link::StatusMessage& status) {
    return !gate_.status_of(status, {senders_[next++], now});
  });
}

// t0 is the stamp of the command that starts the mission, also when it arrives late.
void PlannerInbox::apply(const link::CommandMessage& command) {
  const MissionPhase before = phase_;
  phase_ = phase_after(phase_, command.kind);
  if (before == MissionPhase::kReady && phase_ == MissionPhase::kRunning) {
    t0_utc_ns_ = command.stamp_utc_ns;
  }
}

}  // namespace swarm::planner
