// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "swarm_link/channels/cell.hpp"
#include "swarm_link/messages.hpp"

/// Every topic of the system with its QoS. The vendors translate a Qos in one function each.
namespace swarm::link {

enum class Reliability { kBestEffort, kReliable };
enum class Durability { kVolatile, kTransientLocal };
enum class Ownership { kShared, kExclusive };

struct Qos {
  Reliability reliability = Reliability::kReliable;
  Durability durability = Durability::kVolatile;
  int depth = 1;  ///< keep-last, per instance
  Ownership ownership = Ownership::kShared;
  bool large =
      false;  ///< samples may exceed one datagram (64 KiB): fragmented, sent asynchronously
  bool many_readers = false;  ///< many readers of each sample: one datagram to all of them where possible
  bool operator==(const Qos&) const = default;
};

/// Every message that has a topic.
template <Message... M>
struct MessageList {};
using AllMessages = MessageList<CommandMessage, PlanMessage, SceneMessage, HeartbeatMessage,
                                CellStatesMessage, StatusMessage, EventMessage>;

/// "swarm::wire::FlowPlan", by which the vendors know a message.
template <Message M>
std::string type_name() {
  return "swarm::wire::" + std::string(M::kIdlName);
}

/// A topic of message type M.
template <class M>
struct Topic {
  std::string name;
  Qos qos;
};

inline Topic<CommandMessage> command_topic() {
  return {"swarm/command",
          {.reliability = Reliability::kReliable,
           .durability = Durability::kTransientLocal,
           .depth = 32}};
}

inline Topic<PlanMessage> plan_topic() {
  return {"swarm/plan",
          {.reliability = Reliability::kReliable,
           .durability = Durability::kTransientLocal,
           .depth = 1,
           .ownership = Ownership::kExclusive,
           .large = true}};
}

inline Topic<SceneMessage> scene_topic() {
  return {"swarm/scene",
          {.reliability = Reliability::kReliable,
           .durability = Durability::kTransientLocal,
           .depth = 1,
           .large = true}};
}

inline Topic<HeartbeatMessage> heartbeat_topic() {
  return {"swarm/heartbeat", {.reliability = Reliability::kBestEffort, .depth = 1}};
}

/// `swarm/cell/3_m2` is the cell (3, −2): not every vendor takes a minus in a name.
inline Topic<CellStatesMessage> cell_topic(Cell cell) {
  const auto number = [](std::int32_t n) {
    return n < 0 ? "m" + std::to_string(-static_cast<std::int64_t>(n)) : std::to_string(n);
  };
  return {"swarm/cell/" + number(cell.x) + "_" + number(cell.y),
          {.reliability = Reliability::kBestEffort, .depth = 64, .many_readers = true}};
}

inline Topic<StatusMessage> status_topic() {
  return {"swarm/status", {.reliability = Reliability::kReliable, .depth = 1}};
}

/// For who wants to know where robots are without making them wait for an acknowledgement.
inline Topic<StatusMessage> status_topic_unacknowledged() {
  Topic<StatusMessage> topic = status_topic();
  topic.qos.reliability = Reliability::kBestEffort;
  return topic;
}

inline Topic<EventMessage> event_topic() {
  return {"swarm/event",
          {.reliability = Reliability::kReliable,
           .durability = Durability::kTransientLocal,
           .depth = 64}};
}

}  // namespace swarm::link
