// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>

#include "swarm_link/adapters/fastdds/loopback_transport.hpp"
#include "swarm_link/adapters/fastdds/raw_type.hpp"
#include "swarm_link/adapters/fastdds/topic_registry.hpp"
#include "swarm_link/raw_port.hpp"

namespace swarm::link::fastdds {

/// A data writer of Fast DDS. Exceptions of the vendor do not leave it. \pre publisher and registry
/// outlive it
class FastDdsWriter final : public RawWriter {
 public:
  FastDdsWriter(eprosima::fastdds::dds::Publisher& publisher,
                eprosima::fastdds::dds::DataWriter* writer, TopicRegistry& topics,
                std::string topic)
      : publisher_(publisher), writer_(writer), topics_(topics), topic_(std::move(topic)) {}
  /// Deletes the vendor's writer, then releases the topic.
  ~FastDdsWriter() override;
  /// See RawWriter. Large samples are only queued here, see writer_qos().
  bool write(std::span<const std::byte> bytes) override;
  int matched() const override;

 private:
  eprosima::fastdds::dds::Publisher& publisher_;
  eprosima::fastdds::dds::DataWriter* writer_;  ///< owned; deleted through its publisher
  TopicRegistry& topics_;
  std::string topic_;
};

/// Membership of one reader in the multicast group it receives from, for as long as this object
/// exists. The participant's socket leaves the group with its last member.
class GroupMembership {
 public:
  GroupMembership(std::shared_ptr<ReceiveSockets> sockets, const ReceiveSockets::Locator& group)
      : sockets_(std::move(sockets)), group_(group), joined_(sockets_->join(group_)) {}
  ~GroupMembership() {
    if (joined_) sockets_->leave(group_);
  }
  GroupMembership(const GroupMembership&) = delete;
  GroupMembership& operator=(const GroupMembership&) = delete;
  /// False when the kernel refused the group: then this reader receives nothing.
  bool joined() const { return joined_; }

 private:
  std::shared_ptr<ReceiveSockets> sockets_;
  ReceiveSockets::Locator group_;
  bool joined_;
};

/// A data reader of Fast DDS, polled by its owner: most polls find nothing, and cost one look at a
/// flag that the vendor's receiving thread sets. \pre subscriber and registry outlive it
class FastDdsReader final : public RawReader, private eprosima::fastdds::dds::DataReaderListener {
 public:
  FastDdsReader(eprosima::fastdds::dds::Subscriber& subscriber,
                eprosima::fastdds::dds::DataReader* reader, TopicRegistry& topics,
                std::string topic, std::unique_ptr<GroupMembership> group);
  /// Deletes the vendor's reader, then releases the topic; the group is left last.
  ~FastDdsReader() override;
  std::size_t take(const Sink& sink) override;
  int matched() const override;

 private:
  void on_data_available(eprosima::fastdds::dds::DataReader* /*reader*/) override {
    has_data_ = true;
  }

  eprosima::fastdds::dds::Subscriber& subscriber_;
  eprosima::fastdds::dds::DataReader* reader_;  ///< owned; deleted through its subscriber
  TopicRegistry& topics_;
  std::string topic_;
  std::unique_ptr<GroupMembership> group_;  // null: unicast, at the participant's address
  ByteSample sample_;                       // reused, so that take() does not allocate
  std::atomic<bool> has_data_ = true;       // data may have come before this object
};

}  // namespace swarm::link::fastdds
