// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>

#include "swarm_link/fastdds/topic_registry.hpp"
#include "swarm_link/raw_port.hpp"

namespace swarm::link::fastdds {

/// A type whose samples are their own bytes.
class RawType final : public eprosima::fastdds::dds::TopicDataType {
 public:
  RawType(const std::string& name, bool keyed);

  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;
  bool serialize(void* data, Payload* payload) override;
  bool deserialize(Payload* payload, void* data) override;
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override;
  void* createData() override { return new RawMessage; }
  void deleteData(void* data) override { delete static_cast<RawMessage*>(data); }
  bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle,
              bool force_md5) override;
};

class FastDdsRawWriter final : public RawWriter {
 public:
  FastDdsRawWriter(eprosima::fastdds::dds::Publisher& publisher,
                   eprosima::fastdds::dds::DataWriter* writer, TopicRegistry& topics,
                   std::string topic)
      : publisher_(publisher), writer_(writer), topics_(topics), topic_(std::move(topic)) {}
  ~FastDdsRawWriter() override;
  bool write(const RawMessage& message) override;
  int matched() const override;

 private:
  eprosima::fastdds::dds::Publisher& publisher_;
  eprosima::fastdds::dds::DataWriter* writer_;
  TopicRegistry& topics_;
  std::string topic_;
};

class FastDdsRawReader final : public RawReader {
 public:
  FastDdsRawReader(eprosima::fastdds::dds::Subscriber& subscriber,
                   eprosima::fastdds::dds::DataReader* reader, TopicRegistry& topics,
                   std::string topic)
      : subscriber_(subscriber), reader_(reader), topics_(topics), topic_(std::move(topic)) {}
  ~FastDdsRawReader() override;
  std::size_t take(std::vector<RawMessage>& out) override;
  int matched() const override;

 private:
  eprosima::fastdds::dds::Subscriber& subscriber_;
  eprosima::fastdds::dds::DataReader* reader_;
  TopicRegistry& topics_;
  std::string topic_;
};

}  // namespace swarm::link::fastdds
