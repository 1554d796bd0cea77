// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <exception>

#include "swarm_link/fastdds/conversion.hpp"

namespace swarm::link::fastdds {

/// Whether every sequence in a serialized sample could fit into its bytes. The generated code makes
/// room for as many elements as a sample says before it reads the first: one corrupt length would
/// exhaust memory. Throws what the vendor's decoder throws.
template <class Wire>
bool lengths_fit(const eprosima::fastrtps::rtps::SerializedPayload_t& payload);
template <>
bool lengths_fit<wire::FlowPlan>(const eprosima::fastrtps::rtps::SerializedPayload_t& payload);
template <>
bool lengths_fit<wire::Scene>(const eprosima::fastrtps::rtps::SerializedPayload_t& payload);
template <>
bool lengths_fit<wire::Heartbeat>(const eprosima::fastrtps::rtps::SerializedPayload_t& payload);
template <>
bool lengths_fit<wire::CellStates>(const eprosima::fastrtps::rtps::SerializedPayload_t& payload);
template <>
bool lengths_fit<wire::Command>(const eprosima::fastrtps::rtps::SerializedPayload_t& payload);
template <>
bool lengths_fit<wire::Status>(const eprosima::fastrtps::rtps::SerializedPayload_t& payload);
template <>
bool lengths_fit<wire::Event>(const eprosima::fastrtps::rtps::SerializedPayload_t& payload);

/// Samples that did not decode in this thread. Decoding happens inside take(), in the thread that
/// calls it, so a reader can tell its own failures from others'.
inline thread_local std::uint64_t undecodable_in_thread = 0;

/// The generated type support, safe against bytes that are not a sample.
template <class M>
class GuardedType final : public WireOf<M>::Support {
 public:
  using Wire = typename WireOf<M>::Type;

  GuardedType() {
    // Types are compared by name; their descriptions would only make discovery heavier.
    this->auto_fill_type_object(false);
    this->auto_fill_type_information(false);
  }

  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
    try {
      if (is_plain_cdr(*payload) && lengths_fit<Wire>(*payload) &&
          WireOf<M>::Support::deserialize(payload, data)) {
        return true;
      }
    } catch (const std::exception&) {
      // The decoder's way of saying that the bytes make no sense; counted below.
    }
    ++undecodable_in_thread;
    return false;
  }

 private:
  static bool is_plain_cdr(const eprosima::fastrtps::rtps::SerializedPayload_t& payload) {
    return payload.length >= 4 && payload.data[0] == 0 && payload.data[1] <= 1;
  }
};

}  // namespace swarm::link::fastdds
