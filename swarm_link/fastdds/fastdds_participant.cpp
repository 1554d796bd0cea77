// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/fastdds/fastdds_participant.hpp"

#include <exception>
#include <optional>
#include <utility>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fmt/format.h>

#include "swarm_link/fastdds/endpoints.hpp"
#include "swarm_link/fastdds/entity_qos.hpp"
#include "swarm_link/fastdds/participant_qos.hpp"
#include "swarm_link/typed_participant.hpp"

namespace swarm::link {

namespace fastdds {

namespace dds = eprosima::fastdds::dds;

namespace {

class FastDdsParticipant final : public TypedParticipant<FastDdsParticipant> {
 public:
  FastDdsParticipant(FastDdsOptions options, Ports ports, std::shared_ptr<ReceiveSockets> sockets,
                     dds::DomainParticipant* participant)
      : options_(std::move(options)),
        ports_(ports),
        sockets_(std::move(sockets)),
        participant_(participant),
        publisher_(participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT)),
        subscriber_(participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT)),
        topics_(*participant) {
    register_type<PlanMessage>();
    register_type<SceneMessage>();
    register_type<HeartbeatMessage>();
    register_type<CellStatesMessage>();
    register_type<CommandMessage>();
    register_type<StatusMessage>();
    register_type<EventMessage>();
  }

  ~FastDdsParticipant() override {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  bool usable() const { return publisher_ != nullptr && subscriber_ != nullptr; }

  void receive() override {
    if (options_.receive_at_tick) sockets_->drain();
  }

  Result<void> self_check() const override {
    if (!sockets_->hears_data() || !sockets_->hears_metatraffic()) {
      return fail(ErrorCode::kEnvironment,
                  fmt::format("participant '{}' is deaf: none of {} UDP ports from {}:{} on "
                              "(domain {}, index {}) was free for its {}; end old processes, use "
                              "another domain, or give the address of an interface",
                              options_.name, options_.port_tries + 1, options_.interface,
                              sockets_->hears_metatraffic() ? ports_.data : ports_.metatraffic,
                              options_.domain, options_.index,
                              sockets_->hears_metatraffic() ? "data" : "discovery"));
    }
    if (options_.star && options_.star->is_hub && !sockets_->hears(ports_.metatraffic)) {
      return fail(ErrorCode::kEnvironment,
                  fmt::format("hub '{}': UDP port {}:{} (domain {}, index {}) is taken; end "
                              "old processes or use another domain",
                              options_.name, options_.interface, ports_.metatraffic,
                              options_.domain, options_.index));
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

 private:
  friend class TypedParticipant<FastDdsParticipant>;
  template <class M>
  void register_type() {
    participant_->register_type(dds::TypeSupport(new GuardedType<M>()));
  }

  template <class M>
  static std::string type_name() {
    return GuardedType<M>().getName();
  }

  template <class M>
  Result<WriterPtr<M>> writer(const Topic<M>& topic) {
    try {
      const auto vendor_topic = topics_.acquire(topic.name, type_name<M>());
      if (!vendor_topic) return tl::unexpected(vendor_topic.error());
      const auto qos = writer_qos(topic.qos, options_.ownership_strength);
      auto* made =
          publisher_->create_datawriter(*vendor_topic, qos, nullptr, dds::StatusMask::none());
      if (made == nullptr) return refused_endpoint("writer", topic.name);
      return WriterPtr<M>(new FastDdsWriter<M>(*publisher_, made, topics_, topic.name));
    } catch (const std::exception& e) {
      return fail(ErrorCode::kEnvironment, fmt::format("writer of '{}': {}", topic.name, e.what()));
    }
  }

  template <class M>
  Result<ReaderPtr<M>> reader(const Topic<M>& topic) {
    try {
      const auto vendor_topic = topics_.acquire(topic.name, type_name<M>());
      if (!vendor_topic) return tl::unexpected(vendor_topic.error());
      std::optional<eprosima::fastrtps::rtps::Locator_t> group;
      if (topic.qos.crowd && multicast_) group = group_of(options_.domain, topic.name);
      auto* made = subscriber_->create_datareader(*vendor_topic, reader_qos(topic.qos, group),
                                                  nullptr, dds::StatusMask::none());
      if (made == nullptr) return refused_endpoint("reader", topic.name);
      auto membership = group ? std::make_unique<GroupMembership>(sockets_, *group) : nullptr;
      const bool deaf = membership && !membership->joined();
      auto reader = std::make_unique<FastDdsReader<M>>(*subscriber_, made, topics_, topic.name,
                                                       std::move(membership));
      if (deaf) {
        return fail(ErrorCode::kEnvironment,
                    fmt::format("reader of '{}' cannot join a multicast group", topic.name));
      }
      return reader;
    } catch (const std::exception& e) {
      return fail(ErrorCode::kEnvironment, fmt::format("reader of '{}': {}", topic.name, e.what()));
    }
  }

  tl::unexpected<Error> refused_endpoint(const char* kind, const std::string& topic) {
    topics_.release(topic);
    return fail(ErrorCode::kEnvironment, fmt::format("DDS refused a {} of '{}'", kind, topic));
  }

  FastDdsOptions options_;
  bool multicast_ = options_.receive_at_tick && options_.cells_by_multicast &&
                    carries_multicast(options_.interface);  // else by unicast
  Ports ports_;
  std::shared_ptr<ReceiveSockets> sockets_;
  dds::DomainParticipant* participant_;
  dds::Publisher* publisher_;
  dds::Subscriber* subscriber_;
  TopicRegistry topics_;
};

}  // namespace
}  // namespace fastdds

Result<std::unique_ptr<Participant>> make_fastdds_participant(const FastDdsOptions& options) {
  using namespace fastdds;
  const auto ports = first_ports(options.domain, options.index);
  if (!ports) return tl::unexpected(ports.error());
  if (!options.star && (options.discovery.host != "127.0.0.1" || options.discovery.port == 0)) {
    return fail(ErrorCode::kBadInput,
                fmt::format("discovery server '{}:{}' is not a port on 127.0.0.1",
                            options.discovery.host, options.discovery.port));
  }
  try {
    set_up_library();
    auto sockets = std::make_shared<ReceiveSockets>(ports->data, options.receive_at_tick,
                                                    options.receive_buffer_bytes, options.interface,
                                                    options.faults);
    // The vendor announces a participant before it hands it what its sockets receive: a hub that
    // answers at once would go unheard, and does not repeat itself.
    sockets->set_silent(options.star.has_value());
    auto* participant = dds::DomainParticipantFactory::get_instance()->create_participant(
        options.domain, client_qos(options, *ports, sockets), nullptr, dds::StatusMask::none());
    if (participant == nullptr) {
      return fail(
          ErrorCode::kEnvironment,
          fmt::format("DDS refused participant '{}' in domain {}: see its message on stderr",
                      options.name, options.domain));
    }
    sockets->set_silent(false);
    auto made =
        std::make_unique<FastDdsParticipant>(options, *ports, std::move(sockets), participant);
    if (!made->usable()) {
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

}  // namespace swarm::link
