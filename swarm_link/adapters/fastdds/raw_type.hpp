// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <fastdds/dds/topic/TopicDataType.hpp>

#include "swarm_link/raw_port.hpp"

namespace swarm::link::fastdds {

/// What the vendor takes for a sample: bytes to send, or those it received, which it keeps.
struct ByteSample {
  std::span<const std::byte> bytes{};
  std::vector<std::byte> memory{};
};

/// A type whose samples are their own bytes. Decoding is not the vendor's: it cannot fail here.
class RawType final : public eprosima::fastdds::dds::TopicDataType {
 public:
  explicit RawType(const RawTopic& topic);

  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;
  bool serialize(void* data, Payload* payload) override;
  bool deserialize(Payload* payload, void* data) override;
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override;
  void* createData() override { return new ByteSample; }
  void deleteData(void* data) override { delete static_cast<ByteSample*>(data); }
  bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle,
              bool force_md5) override;
};

}  // namespace swarm::link::fastdds
