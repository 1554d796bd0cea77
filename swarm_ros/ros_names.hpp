// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "swarm_link/port.hpp"
#include "swarmflow/core/result.hpp"

/// Names of ROS 2 as they are on the DDS wire, and endpoints of its messages.
namespace swarm::ros {

/// "rt/r0/cmd_vel" of "/r0/cmd_vel" or "r0/cmd_vel".
inline std::string topic_on_wire(std::string_view topic) {
  while (topic.starts_with('/')) topic.remove_prefix(1);
  return "rt/" + std::string(topic);
}

/// "geometry_msgs::msg::dds_::Twist_" of "geometry_msgs/msg/Twist".
inline std::string type_on_wire(std::string_view type) {
  std::string wire;
  for (std::size_t slash; (slash = type.find('/')) != std::string_view::npos;
       type.remove_prefix(slash + 1)) {
    wire += std::string(type.substr(0, slash)) + "::";
  }
  return wire + "dds_::" + std::string(type) + "_";
}

/// Quality of service as ROS calls it. A writer that is reliable and a reader that is best effort
/// match all others.
struct RosQos {
  bool reliable = false;
  bool latched = false;  ///< transient-local: late readers get the last sample
  int depth = 5;
};
/// Of commands: a writer that cannot deliver must not send old ones later.
inline constexpr RosQos kCommandQos{.reliable = true, .depth = 1};
/// Of our other writers.
inline constexpr RosQos kWriterQos{.reliable = true, .depth = 10};
/// Of our readers: rmw's sensor data.
inline constexpr RosQos kReaderQos{};
/// Of maps.
inline constexpr RosQos kLatchedQos{.reliable = true, .latched = true, .depth = 1};

/// A topic of message M; keyless, as all of ROS.
template <link::Message M>
link::RawTopic raw_topic(std::string_view topic, const RosQos& qos) {
  return {.name = topic_on_wire(topic),
          .type = type_on_wire(M::kRosType),
          .qos = {.reliability =
                      qos.reliable ? link::Reliability::kReliable : link::Reliability::kBestEffort,
                  .durability =
                      qos.latched ? link::Durability::kTransientLocal : link::Durability::kVolatile,
                  .depth = qos.depth,
                  .large = link::contains_sequence<M>()},
          .keyed = false,
          .usual_bytes = 1024};
}

template <link::Message M>
Result<link::WriterPtr<M>> make_writer(link::Participant& participant, std::string_view topic,
                                       const RosQos& qos = kWriterQos) {
  auto raw = participant.make_writer(raw_topic<M>(topic, qos));
  if (!raw) return tl::unexpected(raw.error());
  return std::make_unique<link::EncodingWriter<M>>(std::move(*raw));
}
template <link::Message M>
Result<link::ReaderPtr<M>> make_reader(link::Participant& participant, std::string_view topic,
                                       const RosQos& qos = kReaderQos) {
  auto raw = participant.make_reader(raw_topic<M>(topic, qos));
  if (!raw) return tl::unexpected(raw.error());
  return std::make_unique<link::DecodingReader<M>>(std::move(*raw));
}

}  // namespace swarm::ros
