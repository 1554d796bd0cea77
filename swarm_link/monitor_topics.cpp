// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/monitor_topics.hpp"

namespace swarm::link {
namespace {

/// Replays publish the log records of all robots at control rate, and none may be dropped.
constexpr int kDepth = 10'000;

template <class M>
MonitorTopic topic(const char* recorded, const Topic<M>& topic) {
  return {recorded, raw_topic(topic)};
}

}  // namespace

std::vector<MonitorTopic> monitor_topics() {
  std::vector<MonitorTopic> topics = {topic("swarm/plan", plan_topic()),
                                      topic("swarm/scene", scene_topic()),
                                      topic("swarm/command", command_topic()),
                                      topic("swarm/heartbeat", heartbeat_topic()),
                                      topic("swarm/status", relayed_status_topic()),
                                      topic("swarm/event", relayed_event_topic())};
  for (const char* type : {"Header", "Step", "Belief", "LinkStats", "Note"}) {
    // Topic names are the record types in snake case: LinkStats is blackbox/link_stats.
    std::string name = "blackbox/";
    for (const char* c = type; *c != 0; ++c) {
      if (*c >= 'A' && *c <= 'Z') {
        if (c != type) name += '_';
        name += static_cast<char>(*c - 'A' + 'a');
      } else {
        name += *c;
      }
    }
    topics.push_back({name,
                      {.name = name,
                       .type = std::string("swarm::blackbox::") + type,
                       .qos = {.reliability = Reliability::kReliable, .depth = kDepth}}});
  }
  return topics;
}

MonitorTopic states_topic() {
  return {"swarm/cell",
          {.name = "swarm/relay/states",
           .type = type_name<CellStatesMessage>(),
           .qos = {.reliability = Reliability::kReliable, .depth = kDepth}}};
}

}  // namespace swarm::link
