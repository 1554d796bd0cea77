// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include "swarm_link/adapters/fastdds/fastdds_participant.hpp"
#include "swarm_link/adapters/fastdds/loopback_transport.hpp"
#include "swarm_link/adapters/fastdds/participant_qos.hpp"
#include "swarm_link/adapters/fastdds/topic_registry.hpp"

namespace swarm::link::fastdds {

/// The vendor's domain participant with its publisher, subscriber and topics, independent of the
/// sample types. Owns the vendor's objects and deletes them.
class Entities {
 public:
  /// Creates the participant and its sockets. Fails, without an exception, when the vendor refuses.
  static Result<std::unique_ptr<Entities>> make(const FastDdsOptions& options);
  Entities(FastDdsOptions options, Ports ports, std::shared_ptr<ReceiveSockets> sockets,
           eprosima::fastdds::dds::DomainParticipant* participant);
  ~Entities();
  Entities(const Entities&) = delete;
  Entities& operator=(const Entities&) = delete;

  const FastDdsOptions& options() const { return options_; }
  eprosima::fastdds::dds::Publisher& publisher() { return *publisher_; }
  eprosima::fastdds::dds::Subscriber& subscriber() { return *subscriber_; }
  /// For endpoints, which release their topics.
  TopicRegistry& topics() { return topics_; }
  /// For readers, which join and leave multicast groups.
  const std::shared_ptr<ReceiveSockets>& sockets() { return sockets_; }

  /// Makes a type known to the participant; needed before the first endpoint of that type.
  void register_type(const eprosima::fastdds::dds::TypeSupport& type);

  /// Creates a writer. It counts as a user of its topic until the caller releases the topic in
  /// topics().
  Result<eprosima::fastdds::dds::DataWriter*> make_writer(const std::string& topic,
                                                          const std::string& type, const Qos& qos);
  /// Creates a reader, which counts as a user of its topic in the same way. `group`: multicast
  /// group that it receives from instead of the participant's own address.
  Result<eprosima::fastdds::dds::DataReader*> make_reader(
      const std::string& topic, const std::string& type, const Qos& qos,
      const std::optional<eprosima::fastrtps::rtps::Locator_t>& group = {});

  /// Drains the data sockets in the caller's thread; does nothing if the vendor's threads receive.
  void receive();
  /// See Participant::self_check().
  Result<void> self_check() const;

 private:
  FastDdsOptions options_;
  Ports ports_;                              ///< the first ones tried, for messages
  /// Shared with the transport; null in an open domain.
  std::shared_ptr<ReceiveSockets> sockets_;
  eprosima::fastdds::dds::DomainParticipant* participant_;
  eprosima::fastdds::dds::Publisher* publisher_;
  eprosima::fastdds::dds::Subscriber* subscriber_;
  TopicRegistry topics_;  ///< of writers and readers
};

}  // namespace swarm::link::fastdds
