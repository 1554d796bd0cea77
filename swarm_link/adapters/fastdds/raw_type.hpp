// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <fastdds/dds/topic/TopicDataType.hpp>

#include "swarm_link/raw_port.hpp"

namespace swarm::link::fastdds {

/// The sample type as the vendor sees it: bytes to send (`bytes`, a view), or received bytes that
/// it stores (`memory`, which `bytes` then views).
struct ByteSample {
  std::span<const std::byte> bytes{};
  std::vector<std::byte> memory{};
};

/// A topic type whose samples are CDR bytes already. The vendor neither encodes nor decodes them,
/// so malformed samples reach our own decoder, which counts them.
class RawType final : public eprosima::fastdds::dds::TopicDataType {
 public:
  /// Takes name, key and initial buffer size from the topic.
  explicit RawType(const RawTopic& topic);

  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;
  /// Copies the bytes into the vendor's payload. False if they do not fit.
  bool serialize(void* data, Payload* payload) override;
  /// Copies the received bytes into the sample; never fails.
  bool deserialize(Payload* payload, void* data) override;
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override;
  /// The vendor creates and deletes samples of its readers through these.
  void* createData() override { return new ByteSample; }
  void deleteData(void* data) override { delete static_cast<ByteSample*>(data); }
  /// Computes the instance from the first four bytes of a keyed sample.
  bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle,
              bool force_md5) override;
};

}  // namespace swarm::link::fastdds
