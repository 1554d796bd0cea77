// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <exception>
#include <span>

#include "swarmPubSubTypes.h"
#include "swarm_link/cdr/conversion.hpp"
#include "swarm_link/cdr/lengths_fit.hpp"

namespace swarm::link::fastdds {

/// Generated type support of a message.
template <class M>
struct SupportOf;
template <>
struct SupportOf<PlanMessage> : wire::FlowPlanPubSubType {};
template <>
struct SupportOf<SceneMessage> : wire::ScenePubSubType {};
template <>
struct SupportOf<HeartbeatMessage> : wire::HeartbeatPubSubType {};
template <>
struct SupportOf<CellStatesMessage> : wire::CellStatesPubSubType {};
template <>
struct SupportOf<CommandMessage> : wire::CommandPubSubType {};
template <>
struct SupportOf<StatusMessage> : wire::StatusPubSubType {};
template <>
struct SupportOf<EventMessage> : wire::EventPubSubType {};

/// Samples that did not decode in this thread. Decoding happens inside take(), in the thread that
/// calls it, so a reader can tell its own failures from others'.
inline thread_local std::uint64_t undecodable_in_thread = 0;

/// The generated type support, safe against bytes that are not a sample.
template <class M>
class GuardedType final : public SupportOf<M> {
 public:
  using Wire = typename cdr::WireOf<M>::Type;

  GuardedType() {
    // Types are compared by name; their descriptions would only make discovery heavier.
    this->auto_fill_type_object(false);
    this->auto_fill_type_information(false);
  }

  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override {
    // The encoder skips padding: what the buffer held before must not go out.
    std::fill_n(payload->data, payload->max_size, eprosima::fastrtps::rtps::octet{0});
    return SupportOf<M>::serialize(data, payload);
  }

  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
    try {
      const std::span bytes(reinterpret_cast<std::byte*>(payload->data), payload->length);
      if (cdr::is_plain(bytes) && cdr::lengths_fit<Wire>(bytes) &&
          SupportOf<M>::deserialize(payload, data)) {
        return true;
      }
    } catch (const std::exception&) {
      // The decoder's way of saying that the bytes make no sense; counted below.
    }
    ++undecodable_in_thread;
    return false;
  }
};

}  // namespace swarm::link::fastdds
