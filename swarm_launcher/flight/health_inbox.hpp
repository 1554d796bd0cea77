// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "swarm_link/gate/gate.hpp"
#include "swarm_link/port.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// Statuses and events of robots and planner as the launcher receives them: takes everything that
/// arrived, lets the Gate check it, and offers what passed. Not thread-safe.
class HealthInbox {
 public:
  HealthInbox(link::ReaderPtr<link::StatusMessage> statuses,
              link::ReaderPtr<link::EventMessage> events, const link::WireLimits& limits);

  /// Replaces what the previous call received.
  void receive(UtcTime now);

  /// Of the last receive(); robot ids are those of the mission.
  std::span<const link::StatusMessage> statuses() const { return statuses_; }
  /// Of the last receive().
  std::span<const link::EventMessage> events() const { return events_; }

  const link::RefusalCounters& refused() const { return gate_.refused(); }

 private:
  link::ReaderPtr<link::StatusMessage> status_reader_;
  link::ReaderPtr<link::EventMessage> event_reader_;
  link::Gate gate_;
  std::vector<link::StatusMessage> statuses_;
  std::vector<link::EventMessage> events_;
};

}  // namespace swarm::launcher
