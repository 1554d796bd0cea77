// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/adapters/fastdds/topic_registry.hpp"

#include <fmt/format.h>

#include "swarm_core/base/assert.hpp"

namespace swarm::link::fastdds {

namespace dds = eprosima::fastdds::dds;

// The vendor fails when a topic is created twice in a participant: all endpoints share one.
Result<dds::Topic*> TopicRegistry::acquire(const std::string& name, const std::string& type) {
  const auto [it, inserted] = entries_.try_emplace(name);
  auto& entry = it->second;
  if (inserted) entry.topic = participant_.create_topic(name, type, dds::TOPIC_QOS_DEFAULT);
  if (entry.topic == nullptr) {
    entries_.erase(it);
    return fail(ErrorCode::kEnvironment, fmt::format("DDS refused the topic '{}'", name));
  }
  if (entry.topic->get_type_name() != type) {
    return fail(ErrorCode::kBadInput, fmt::format("topic '{}' carries {}, not {}", name,
                                                  entry.topic->get_type_name(), type));
  }
  ++entry.uses;
  return entry.topic;
}

void TopicRegistry::release(const std::string& name) {
  const auto it = entries_.find(name);
  SWARM_ASSERT(it != entries_.end());
  if (--it->second.uses > 0) return;
  participant_.delete_topic(it->second.topic);
  entries_.erase(it);
}

}  // namespace swarm::link::fastdds
