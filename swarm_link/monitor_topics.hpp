// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "swarm_link/raw_port.hpp"

/// Topics for monitors. Agents with static peers are connected to launcher and planner only; the
/// launcher republishes their statuses and events for monitors on topics of its own.
namespace swarm::link {

/// Statuses, republished; `depth` counts per group of robots.
inline Topic<StatusMessage> relayed_status_topic() {
  return {"swarm/relay/status", {.reliability = Reliability::kReliable, .depth = 16}};
}

/// Events, republished; transient-local, so that a monitor that joins late receives the last ones.
inline Topic<EventMessage> relayed_event_topic() {
  return {"swarm/relay/event",
          {.reliability = Reliability::kReliable,
           .durability = Durability::kTransientLocal,
           .depth = 256}};
}

/// A topic of recordings and the topic of the bus that carries it.
struct MonitorTopic {
  std::string recorded{};  ///< its name in a recording
  RawTopic wire{};         ///< its topic on the bus
};

/// All topics a monitor reads except robot states, which are sent by cells. A replay publishes
/// states on states_topic().
std::vector<MonitorTopic> monitor_topics();
MonitorTopic states_topic();

}  // namespace swarm::link
