// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "swarm_link/gate/gate.hpp"
#include "swarm_link/port.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// Statuses and events of robots and planner and the planner's heartbeats as the launcher receives
/// them: takes everything that arrived, lets the Gate check it, and offers what passed. Not
/// thread-safe.
class HealthInbox {
 public:
  struct Readers {
    link::ReaderPtr<link::StatusMessage> status;
    link::ReaderPtr<link::EventMessage> event;
    link::ReaderPtr<link::HeartbeatMessage> heartbeat;
  };
  HealthInbox(Readers readers, const link::WireLimits& limits);

  /// Replaces what the previous call received.
  void receive(UtcTime now);

  /// The process of a robot has ended: the next one's statuses come from another sender.
  void release_status(RobotId robot, UtcTime now) { gate_.release_status(robot, now); }

  /// Of the last receive(); robot ids are those of the mission, each from its own sender.
  std::span<const link::StatusMessage> statuses() const { return statuses_; }
  /// Of the last receive().
  std::span<const link::EventMessage> events() const { return events_; }
  /// Who published each of events(); see RawSample::sender.
  std::span<const std::uint64_t> event_senders() const { return event_senders_; }
  /// Of the last receive().
  std::span<const link::HeartbeatMessage> heartbeats() const { return heartbeats_; }

  const link::RefusalCounters& refused() const { return gate_.refused(); }

 private:
  Readers readers_;
  link::Gate gate_;
  std::vector<link::StatusMessage> statuses_;
  std::vector<link::EventMessage> events_;
  std::vector<std::uint64_t> event_senders_;
  std::vector<link::HeartbeatMessage> heartbeats_;
  std::vector<std::uint64_t> senders_;
};

}  // namespace swarm::launcher
