// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>

#include "swarm_link/fastdds/guarded_type.hpp"
#include "swarm_link/fastdds/loopback_transport.hpp"
#include "swarm_link/fastdds/topic_registry.hpp"
#include "swarm_link/port.hpp"

namespace swarm::link::fastdds {

template <class M>
class FastDdsWriter final : public Writer<M> {
 public:
  FastDdsWriter(eprosima::fastdds::dds::Publisher& publisher,
                eprosima::fastdds::dds::DataWriter* writer, TopicRegistry& topics,
                std::string topic)
      : publisher_(publisher), writer_(writer), topics_(topics), topic_(std::move(topic)) {}

  ~FastDdsWriter() override {
    publisher_.delete_datawriter(writer_);
    topics_.release(topic_);
  }

  bool write(const M& message) override {
    try {
      return cdr::to_wire(message, wire_) && writer_->write(&wire_);
    } catch (const std::exception&) {
      return false;
    }
  }

  int matched() const override {
    eprosima::fastdds::dds::PublicationMatchedStatus status;
    writer_->get_publication_matched_status(status);
    return status.current_count;
  }

 private:
  eprosima::fastdds::dds::Publisher& publisher_;
  eprosima::fastdds::dds::DataWriter* writer_;
  TopicRegistry& topics_;
  std::string topic_;
  typename cdr::WireOf<M>::Type wire_;  // kept for its memory
};

/// A reader's hold on the multicast group it listens to.
class GroupMembership {
 public:
  GroupMembership(std::shared_ptr<ReceiveSockets> sockets, const ReceiveSockets::Locator& group)
      : sockets_(std::move(sockets)), group_(group), joined_(sockets_->join(group_)) {}
  ~GroupMembership() {
    if (joined_) sockets_->leave(group_);
  }
  GroupMembership(const GroupMembership&) = delete;
  GroupMembership& operator=(const GroupMembership&) = delete;
  bool joined() const { return joined_; }

 private:
  std::shared_ptr<ReceiveSockets> sockets_;
  ReceiveSockets::Locator group_;
  bool joined_;
};

template <class M>
class FastDdsReader final : public Reader<M> {
 public:
  FastDdsReader(eprosima::fastdds::dds::Subscriber& subscriber,
                eprosima::fastdds::dds::DataReader* reader, TopicRegistry& topics,
                std::string topic, std::unique_ptr<GroupMembership> group)
      : subscriber_(subscriber),
        reader_(reader),
        topics_(topics),
        topic_(std::move(topic)),
        group_(std::move(group)) {}

  ~FastDdsReader() override {
    subscriber_.delete_datareader(reader_);
    topics_.release(topic_);
  }

  std::size_t take(std::vector<M>& out) override {
    const auto before = out.size();
    const auto undecodable_before = undecodable_in_thread;
    try {
      eprosima::fastdds::dds::SampleInfo info;
      while (reader_->take_next_sample(&wire_, &info) == ReturnCode_t::RETCODE_OK) {
        if (!info.valid_data) continue;  // a writer went away
        cdr::from_wire(wire_, out.emplace_back());
      }
    } catch (const std::exception&) {
      ++undecodable_in_thread;
    }
    undecodable_ += undecodable_in_thread - undecodable_before;
    return out.size() - before;
  }

  int matched() const override {
    eprosima::fastdds::dds::SubscriptionMatchedStatus status;
    reader_->get_subscription_matched_status(status);
    return status.current_count;
  }

  std::uint64_t undecodable() const override { return undecodable_; }

 private:
  eprosima::fastdds::dds::Subscriber& subscriber_;
  eprosima::fastdds::dds::DataReader* reader_;
  TopicRegistry& topics_;
  std::string topic_;
  std::unique_ptr<GroupMembership> group_;  // null: hears at the participant's own address
  typename cdr::WireOf<M>::Type wire_;      // kept for its memory
  std::uint64_t undecodable_ = 0;
};

}  // namespace swarm::link::fastdds
