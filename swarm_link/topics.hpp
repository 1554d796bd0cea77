// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "swarm_link/channels/cell.hpp"
#include "swarm_link/messages.hpp"

/// Every topic of the system with its QoS. Each adapter translates a Qos in one function.
namespace swarm::link {

/// The QoS policies of DDS that we use.
enum class Reliability { kBestEffort, kReliable };
enum class Durability { kVolatile, kTransientLocal };

/// QoS of a topic, the same for its writers and readers but for `reader_depth`.
struct Qos {
  Reliability reliability = Reliability::kReliable;  ///< best effort: losses are not repaired
  Durability durability = Durability::kVolatile;  ///< transient-local: late readers get the history
  int depth = 1;                                  ///< keep-last history, per instance
  /// The same of readers, if larger: a refused sample that arrives just behind a good one must not
  /// displace it before it is taken.
  int reader_depth = 0;
  bool large = false;         ///< may exceed one datagram (64 KiB): fragmented, sent asynchronously
  bool many_readers = false;  ///< sent by multicast where possible
  bool operator==(const Qos&) const = default;
};

/// Every message that has a topic.
template <Message... M>
struct MessageList {};
using AllMessages = MessageList<CommandMessage, PlanMessage, SceneMessage, HeartbeatMessage,
                                CellStatesMessage, StatusMessage, EventMessage>;

/// The DDS type name, such as "swarm::wire::FlowPlan".
template <Message M>
std::string type_name() {
  return "swarm::wire::" + std::string(M::kIdlName);
}

/// A topic of message type M.
template <class M>
struct Topic {
  std::string name;  ///< as DDS tools display it
  Qos qos;
};

/// Transient-local, so that a restarted process receives the commands that it missed.
inline Topic<CommandMessage> command_topic() {
  return {"swarm/command",
          {.reliability = Reliability::kReliable,
           .durability = Durability::kTransientLocal,
           .depth = 1024}};
}

/// Depth 1: only the newest plan counts. Which of several planners leads is decided by their
/// heartbeats (RulingPlanner), and not by exclusive ownership: DDS would drop the planner's plans
/// uncounted while there is any stronger writer.
inline Topic<PlanMessage> plan_topic() {
  return {"swarm/plan",
          {.reliability = Reliability::kReliable,
           .durability = Durability::kTransientLocal,
           .depth = 1,
           .reader_depth = 8,
           .large = true}};
}

/// Depth 1: a scene contains all changes, so the newest is enough for a late reader.
inline Topic<SceneMessage> scene_topic() {
  return {"swarm/scene",
          {.reliability = Reliability::kReliable,
           .durability = Durability::kTransientLocal,
           .depth = 1,
           .reader_depth = 8,
           .large = true}};
}

/// Best effort: a late heartbeat is useless, the next one follows soon.
inline Topic<HeartbeatMessage> heartbeat_topic() {
  return {"swarm/heartbeat",
          {.reliability = Reliability::kBestEffort, .depth = 1, .reader_depth = 16}};
}

/// `swarm/cell/3_m2` is the cell (3, −2): not every vendor accepts a minus sign in a name. Best
/// effort: a state that has to be sent again would be outdated.
inline Topic<CellStatesMessage> cell_topic(Cell cell) {
  const auto number = [](std::int32_t n) {
    return n < 0 ? "m" + std::to_string(-static_cast<std::int64_t>(n)) : std::to_string(n);
  };
  return {"swarm/cell/" + number(cell.x) + "_" + number(cell.y),
          {.reliability = Reliability::kBestEffort, .depth = 64, .many_readers = true}};
}

/// States for all processes of a run, whatever cell they are in: see
/// StateChannel::publish_everywhere().
inline Topic<CellStatesMessage> everywhere_topic() {
  return {"swarm/everywhere",
          {.reliability = Reliability::kBestEffort, .depth = 64, .many_readers = true}};
}

/// Reliable with depth 1 per group of robots: the newest status must arrive, older ones need not.
inline Topic<StatusMessage> status_topic() {
  return {"swarm/status", {.reliability = Reliability::kReliable, .depth = 1, .reader_depth = 8}};
}

/// Best-effort reader for monitors of positions: the agents' writers do not wait for its
/// acknowledgements.
inline Topic<StatusMessage> status_topic_unacknowledged() {
  Topic<StatusMessage> topic = status_topic();
  topic.qos.reliability = Reliability::kBestEffort;
  return topic;
}

/// Reliable and transient-local: events must arrive even at a reader that joins later.
inline Topic<EventMessage> event_topic() {
  return {"swarm/event",
          {.reliability = Reliability::kReliable,
           .durability = Durability::kTransientLocal,
           .depth = 64}};
}

}  // namespace swarm::link
