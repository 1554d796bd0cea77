// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "swarm_link/raw_port.hpp"

/// What those who look on read. Agents of a star know nobody but launcher and planner: what they
/// say of themselves the launcher says again, to whom it matters, on topics of its own.
namespace swarm::link {

inline Topic<StatusMessage> relayed_status_topic() {
  return {"swarm/relay/status", {.reliability = Reliability::kReliable, .depth = 16}};
}

inline Topic<EventMessage> relayed_event_topic() {
  return {"swarm/relay/event",
          {.reliability = Reliability::kReliable,
           .durability = Durability::kTransientLocal,
           .depth = 256}};
}

/// A topic of recordings and how it travels.
struct MonitorTopic {
  std::string recorded{};  ///< its name in a recording
  RawTopic wire{};
};

/// States are not among them: those go by cells. A replay says them on states_topic().
std::vector<MonitorTopic> monitor_topics();
MonitorTopic states_topic();

}  // namespace swarm::link
