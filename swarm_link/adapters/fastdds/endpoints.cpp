// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/adapters/fastdds/endpoints.hpp"

#include <cstdint>
#include <cstring>
#include <exception>
#include <utility>

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

namespace swarm::link::fastdds {

namespace dds = eprosima::fastdds::dds;

namespace {

// By participant: a process that makes many writers is one sender.
std::uint64_t sender_of(const dds::SampleInfo& info) {
  const auto& prefix = info.sample_identity.writer_guid().guidPrefix;
  std::uint64_t host_and_process = 0;
  std::uint32_t participant = 0;
  static_assert(sizeof prefix.value == sizeof host_and_process + sizeof participant);
  std::memcpy(&host_and_process, prefix.value, sizeof host_and_process);
  std::memcpy(&participant, prefix.value + sizeof host_and_process, sizeof participant);
  return host_and_process ^ (std::uint64_t{participant} << 32U);
}

}  // namespace

// The endpoint goes before its topic: the vendor refuses to delete a topic in use.
FastDdsWriter::~FastDdsWriter() {
  publisher_.delete_datawriter(writer_);
  topics_.release(topic_);
}

// The sample only views the bytes; serialize() copies them within the call.
bool FastDdsWriter::write(std::span<const std::byte> bytes) {
  try {
    ByteSample sample{.bytes = bytes};
    return writer_->write(&sample);
  } catch (const std::exception&) {
    return false;
  }
}

int FastDdsWriter::matched() const {
  dds::PublicationMatchedStatus status;
  writer_->get_publication_matched_status(status);
  return status.current_count;
}

FastDdsReader::FastDdsReader(dds::Subscriber& subscriber, dds::DataReader* reader,
                             TopicRegistry& topics, std::string topic,
                             std::unique_ptr<GroupMembership> group)
    : subscriber_(subscriber),
      reader_(reader),
      topics_(topics),
      topic_(std::move(topic)),
      group_(std::move(group)) {
  reader_->set_listener(this, dds::StatusMask::data_available());
}

FastDdsReader::~FastDdsReader() {
  reader_->set_listener(nullptr);
  subscriber_.delete_datareader(reader_);
  topics_.release(topic_);
}

// Takes one sample at a time into a buffer that is reused: no allocation once it has grown.
std::size_t FastDdsReader::take(const Sink& sink) {
  if (!has_data_.exchange(false)) return 0;  // the vendor would take a lock and its clock
  std::size_t taken = 0;
  try {
    dds::SampleInfo info;
    while (reader_->take_next_sample(&sample_, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;  // a notice that a writer has left
      sink({.bytes = sample_.bytes,
            .published_utc_ns = info.source_timestamp.to_ns(),
            .sender = sender_of(info)});
      ++taken;
    }
  } catch (const std::exception&) {
    has_data_ = true;  // no exception leaves the adapter; the next call continues
  }
  return taken;
}

int FastDdsReader::matched() const {
  dds::SubscriptionMatchedStatus status;
  reader_->get_subscription_matched_status(status);
  return status.current_count;
}

}  // namespace swarm::link::fastdds
