// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/adapters/fastdds/entities.hpp"

#include <exception>
#include <utility>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fmt/format.h>

#include "swarm_link/adapters/fastdds/entity_qos.hpp"

namespace swarm::link::fastdds {

namespace dds = eprosima::fastdds::dds;

namespace {

/// A participant and the sockets that it receives from; in an open domain the vendor has its own.
struct Created {
  dds::DomainParticipant* participant = nullptr;
  Ports ports{};
  std::shared_ptr<ReceiveSockets> sockets{};
};

dds::DomainParticipant* create(const FastDdsOptions& options,
                               const dds::DomainParticipantQos& qos) {
  return dds::DomainParticipantFactory::get_instance()->create_participant(
      options.domain, qos, nullptr, dds::StatusMask::none());
}

/// Creates the sockets, then the participant over them. Discovery servers other than on loopback
/// are refused, since such a server is bound to it.
Result<Created> create_in_run(const FastDdsOptions& options) {
  const auto ports = first_ports(options.domain, options.index);
  if (!ports) return tl::unexpected(ports.error());
  if (!options.static_peers &&
      (options.discovery.host != "127.0.0.1" || options.discovery.port == 0)) {
    return fail(ErrorCode::kBadInput,
                fmt::format("discovery server '{}:{}' is not a port on 127.0.0.1",
                            options.discovery.host, options.discovery.port));
  }
  auto sockets = std::make_shared<ReceiveSockets>(ports->data, options.receive_at_tick,
                                                  options.receive_buffer_bytes, options.interface,
                                                  options.faults);
  // The vendor announces a participant before it delivers what its sockets receive. A peer that
  // answers at once would not be received and does not repeat its answer; so announcements are
  // discarded until the participant is complete.
  sockets->set_silent(options.static_peers.has_value());
  auto* participant = create(options, client_qos(options, *ports, sockets));
  sockets->set_silent(false);
  return Created{participant, *ports, std::move(sockets)};
}

}  // namespace

// Then publisher and subscriber.
Result<std::unique_ptr<Entities>> Entities::make(const FastDdsOptions& options) {
  try {
    set_up_library();
    auto created = options.open ? Result<Created>(Created{create(options, open_qos(options))})
                                : create_in_run(options);
    if (!created) return tl::unexpected(created.error());
    if (created->participant == nullptr) {
      return fail(
          ErrorCode::kEnvironment,
          fmt::format("DDS refused participant '{}' in domain {}: see its message on stderr",
                      options.name, options.domain));
    }
    auto made = std::make_unique<Entities>(options, created->ports, std::move(created->sockets),
                                           created->participant);
    if (made->publisher_ == nullptr || made->subscriber_ == nullptr) {
      return fail(
          ErrorCode::kEnvironment,
          fmt::format("DDS gave participant '{}' no publisher or subscriber", options.name));
    }
    return made;
  } catch (const std::exception& e) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("DDS participant '{}': {}", options.name, e.what()));
  }
}

Entities::Entities(FastDdsOptions options, Ports ports, std::shared_ptr<ReceiveSockets> sockets,
                   dds::DomainParticipant* participant)
    : options_(std::move(options)),
      ports_(ports),
      sockets_(std::move(sockets)),
      participant_(participant),
      publisher_(participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT)),
      subscriber_(participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT)),
      topics_(*participant) {}

// The vendor deletes a participant only after everything it contains.
Entities::~Entities() {
  participant_->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

void Entities::register_type(const dds::TypeSupport& type) { participant_->register_type(type); }

// On failure the topic is released again, so that it does not stay registered without a user.
Result<dds::DataWriter*> Entities::make_writer(const std::string& topic, const std::string& type,
                                               const Qos& qos) {
  const auto vendor_topic = topics_.acquire(topic, type);
  if (!vendor_topic) return tl::unexpected(vendor_topic.error());
  auto* made = publisher_->create_datawriter(*vendor_topic, writer_qos(qos), nullptr,
                                             dds::StatusMask::none());
  if (made != nullptr) return made;
  topics_.release(topic);
  return fail(ErrorCode::kEnvironment, fmt::format("DDS refused a writer of '{}'", topic));
}

Result<dds::DataReader*> Entities::make_reader(
    const std::string& topic, const std::string& type, const Qos& qos,
    const std::optional<eprosima::fastrtps::rtps::Locator_t>& group) {
  const auto vendor_topic = topics_.acquire(topic, type);
  if (!vendor_topic) return tl::unexpected(vendor_topic.error());
  auto* made = subscriber_->create_datareader(*vendor_topic, reader_qos(qos, group), nullptr,
                                              dds::StatusMask::none());
  if (made != nullptr) return made;
  topics_.release(topic);
  return fail(ErrorCode::kEnvironment, fmt::format("DDS refused a reader of '{}'", topic));
}

// Otherwise the vendor's threads receive.
void Entities::receive() {
  if (sockets_ != nullptr && options_.receive_at_tick) sockets_->drain();
}

// The vendor reports none of these failures: a participant without a free port simply receives
// nothing. Checked here: a data and a discovery port, the known port of a relay participant, and
// the size of the receive buffers that the kernel grants.
Result<void> Entities::self_check() const {
  if (sockets_ == nullptr) return {};  // of an open domain: the vendor chooses its ports
  if (!sockets_->can_receive_data() || !sockets_->can_receive_metatraffic()) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("participant '{}' cannot receive: none of {} UDP ports from {}:{} on "
                            "(domain {}, index {}) was free for its {}; end old processes, use "
                            "another domain, or give the address of an interface",
                            options_.name, options_.port_tries + 1, options_.interface,
                            sockets_->can_receive_metatraffic() ? ports_.data : ports_.metatraffic,
                            options_.domain, options_.index,
                            sockets_->can_receive_metatraffic() ? "data" : "discovery"));
  }
  if (options_.static_peers && options_.static_peers->is_relay &&
      !sockets_->can_receive(ports_.metatraffic)) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("relay '{}': UDP port {}:{} (domain {}, index {}) is taken; end "
                            "old processes or use another domain",
                            options_.name, options_.interface, ports_.metatraffic, options_.domain,
                            options_.index));
  }
  const int granted = granted_receive_buffer_bytes(options_.receive_buffer_bytes);
  if (granted < options_.receive_buffer_bytes / 2) {
    return fail(ErrorCode::kEnvironment,
                fmt::format("participant '{}' asked for receive buffers of {} bytes and got {}: "
                            "run 'sysctl -w net.core.rmem_max={}' as root",
                            options_.name, options_.receive_buffer_bytes, granted,
                            options_.receive_buffer_bytes));
  }
  return {};
}

}  // namespace swarm::link::fastdds
