// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/adapters/fastdds/raw_type.hpp"

#include <algorithm>
#include <cstdint>

namespace swarm::link::fastdds {

RawType::RawType(const RawTopic& topic) {
  setName(topic.type.c_str());
  m_typeSize = static_cast<std::uint32_t>(topic.usual_bytes);
  m_isGetKeyDefined = topic.keyed;
  // Types are matched by name. Descriptions of types would only increase the discovery traffic.
  auto_fill_type_object(false);
  auto_fill_type_information(false);
}

// Writes the bytes as they are. The payload's own encapsulation field repeats the byte order.
bool RawType::serialize(void* data, Payload* payload) {
  const auto bytes = static_cast<ByteSample*>(data)->bytes;
  if (bytes.size() < cdr::kEncapsulationBytes || bytes.size() > payload->max_size) return false;
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<std::byte*>(payload->data));
  payload->length = static_cast<std::uint32_t>(bytes.size());
  payload->encapsulation = static_cast<std::uint16_t>(bytes[1]);
  return true;
}

// Copies the payload and never fails: the vendor would drop the sample without counting it.
bool RawType::deserialize(Payload* payload, void* data) {
  const auto* bytes = reinterpret_cast<const std::byte*>(payload->data);
  auto& sample = *static_cast<ByteSample*>(data);
  sample.memory.assign(bytes, bytes + payload->length);
  sample.bytes = sample.memory;
  return true;
}

// The vendor asks this for the size of the payload buffer that serialize() needs.
std::function<std::uint32_t()> RawType::getSerializedSizeProvider(void* data) {
  return
      [data] { return static_cast<std::uint32_t>(static_cast<ByteSample*>(data)->bytes.size()); };
}

bool RawType::getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle, bool) {
  if (!m_isGetKeyDefined) return false;
  const auto bytes = static_cast<ByteSample*>(data)->bytes;
  if (bytes.size() < cdr::kEncapsulationBytes + sizeof(std::uint32_t)) return false;
  // The key is serialized big-endian, independent of the byte order of the sample.
  const bool little = bytes[1] == std::byte{1};
  for (std::size_t i = 0; i < 16; ++i) {
    handle->value[i] =
        i < 4 ? std::to_integer<std::uint8_t>(bytes[little ? 7 - i : 4 + i]) : std::uint8_t{0};
  }
  return true;
}

}  // namespace swarm::link::fastdds
