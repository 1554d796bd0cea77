// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/fastdds/raw_endpoints.hpp"

#include <algorithm>
#include <exception>
#include <utility>

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

namespace swarm::link::fastdds {

namespace dds = eprosima::fastdds::dds;

RawType::RawType(const std::string& name, bool keyed) {
  setName(name.c_str());
  m_typeSize = 1U << 16U;
  m_isGetKeyDefined = keyed;
  auto_fill_type_object(false);
  auto_fill_type_information(false);
}

bool RawType::serialize(void* data, Payload* payload) {
  const auto& message = *static_cast<RawMessage*>(data);
  if (message.bytes.size() < 4 || message.bytes.size() > payload->max_size) return false;
  std::copy(message.bytes.begin(), message.bytes.end(),
            reinterpret_cast<std::byte*>(payload->data));
  payload->length = static_cast<std::uint32_t>(message.bytes.size());
  payload->encapsulation = static_cast<std::uint16_t>(message.bytes[1]);
  return true;
}

bool RawType::deserialize(Payload* payload, void* data) {
  const auto* bytes = reinterpret_cast<const std::byte*>(payload->data);
  static_cast<RawMessage*>(data)->bytes.assign(bytes, bytes + payload->length);
  return true;
}

std::function<std::uint32_t()> RawType::getSerializedSizeProvider(void* data) {
  return
      [data] { return static_cast<std::uint32_t>(static_cast<RawMessage*>(data)->bytes.size()); };
}

bool RawType::getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle, bool) {
  if (!m_isGetKeyDefined) return false;
  const auto& bytes = static_cast<RawMessage*>(data)->bytes;
  if (bytes.size() < 8) return false;
  // A key's serialization is big-endian, whatever the sample's.
  const bool little = bytes[1] == std::byte{1};
  for (std::size_t i = 0; i < 16; ++i) {
    handle->value[i] =
        i < 4 ? std::to_integer<std::uint8_t>(bytes[little ? 7 - i : 4 + i]) : std::uint8_t{0};
  }
  return true;
}

FastDdsRawWriter::~FastDdsRawWriter() {
  publisher_.delete_datawriter(writer_);
  topics_.release(topic_);
}

bool FastDdsRawWriter::write(const RawMessage& message) {
  try {
    return writer_->write(const_cast<RawMessage*>(&message));
  } catch (const std::exception&) {
    return false;
  }
}

int FastDdsRawWriter::matched() const {
  dds::PublicationMatchedStatus status;
  writer_->get_publication_matched_status(status);
  return status.current_count;
}

FastDdsRawReader::~FastDdsRawReader() {
  subscriber_.delete_datareader(reader_);
  topics_.release(topic_);
}

std::size_t FastDdsRawReader::take(std::vector<RawMessage>& out) {
  const std::size_t before = out.size();
  try {
    RawMessage message;
    dds::SampleInfo info;
    while (reader_->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;  // a writer went away
      message.said_utc_ns = info.source_timestamp.to_ns();
      out.push_back(std::move(message));
    }
  } catch (const std::exception&) {
    return out.size() - before;
  }
  return out.size() - before;
}

int FastDdsRawReader::matched() const {
  dds::SubscriptionMatchedStatus status;
  reader_->get_subscription_matched_status(status);
  return status.current_count;
}

}  // namespace swarm::link::fastdds
