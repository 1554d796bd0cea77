// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/fastdds/fastdds_participant.hpp"

#include <exception>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "swarm_link/fastdds/endpoints.hpp"
#include "swarm_link/fastdds/entities.hpp"
#include "swarm_link/fastdds/entity_qos.hpp"
#include "swarm_link/fastdds/raw_endpoints.hpp"
#include "swarm_link/typed_participant.hpp"
#include "swarm_link/udp_socket.hpp"

namespace swarm::link {
namespace fastdds {
namespace {

/// What the vendor throws ends here.
template <class Make>
auto guarded(const char* kind, const std::string& topic, Make make) -> decltype(make()) {
  try {
    return make();
  } catch (const std::exception& e) {
    return fail(ErrorCode::kEnvironment, fmt::format("{} of '{}': {}", kind, topic, e.what()));
  }
}

class FastDdsParticipant final : public TypedParticipant<FastDdsParticipant> {
 public:
  explicit FastDdsParticipant(std::unique_ptr<Entities> entities) : entities_(std::move(entities)) {
    register_type<PlanMessage>();
    register_type<SceneMessage>();
    register_type<HeartbeatMessage>();
    register_type<CellStatesMessage>();
    register_type<CommandMessage>();
    register_type<StatusMessage>();
    register_type<EventMessage>();
  }

  void receive() override { entities_->receive(); }

  Result<void> self_check() const override { return entities_->self_check(); }

 private:
  friend class TypedParticipant<FastDdsParticipant>;
  template <class M>
  void register_type() {
    entities_->register_type(eprosima::fastdds::dds::TypeSupport(new GuardedType<M>()));
  }

  template <class M>
  static std::string type_name() {
    return GuardedType<M>().getName();
  }

  template <class M>
  Result<WriterPtr<M>> writer(const Topic<M>& topic) {
    return guarded("writer", topic.name, [&]() -> Result<WriterPtr<M>> {
      const auto made = entities_->make_writer(topic.name, type_name<M>(), topic.qos);
      if (!made) return tl::unexpected(made.error());
      return std::make_unique<FastDdsWriter<M>>(entities_->publisher(), *made, entities_->topics(),
                                                topic.name);
    });
  }

  template <class M>
  Result<ReaderPtr<M>> reader(const Topic<M>& topic) {
    return guarded("reader", topic.name, [&]() -> Result<ReaderPtr<M>> {
      std::optional<eprosima::fastrtps::rtps::Locator_t> group;
      if (topic.qos.crowd && multicast_) group = group_of(entities_->options().domain, topic.name);
      const auto made = entities_->make_reader(topic.name, type_name<M>(), topic.qos, group);
      if (!made) return tl::unexpected(made.error());
      auto membership =
          group ? std::make_unique<GroupMembership>(entities_->sockets(), *group) : nullptr;
      const bool deaf = membership && !membership->joined();
      auto reader = std::make_unique<FastDdsReader<M>>(
          entities_->subscriber(), *made, entities_->topics(), topic.name, std::move(membership));
      if (deaf) {
        return fail(ErrorCode::kEnvironment,
                    fmt::format("reader of '{}' cannot join a multicast group", topic.name));
      }
      return reader;
    });
  }

  std::unique_ptr<Entities> entities_;
  bool multicast_ = entities_->options().receive_at_tick &&
                    entities_->options().cells_by_multicast &&
                    carries_multicast(entities_->options().interface);  // else by unicast
};

class FastDdsRawParticipant final : public RawParticipant {
 public:
  explicit FastDdsRawParticipant(std::unique_ptr<Entities> entities)
      : entities_(std::move(entities)) {}

  Result<std::unique_ptr<RawWriter>> make_writer(const RawTopic& topic) override {
    return guarded("writer", topic.name, [&]() -> Result<std::unique_ptr<RawWriter>> {
      register_type(topic);
      const auto made = entities_->make_writer(topic.name, topic.type, topic.qos);
      if (!made) return tl::unexpected(made.error());
      return std::make_unique<FastDdsRawWriter>(entities_->publisher(), *made, entities_->topics(),
                                                topic.name);
    });
  }

  Result<std::unique_ptr<RawReader>> make_reader(const RawTopic& topic) override {
    return guarded("reader", topic.name, [&]() -> Result<std::unique_ptr<RawReader>> {
      register_type(topic);
      const auto made = entities_->make_reader(topic.name, topic.type, topic.qos);
      if (!made) return tl::unexpected(made.error());
      return std::make_unique<FastDdsRawReader>(entities_->subscriber(), *made, entities_->topics(),
                                                topic.name);
    });
  }

  void receive() override { entities_->receive(); }

 private:
  void register_type(const RawTopic& topic) {
    entities_->register_type(
        eprosima::fastdds::dds::TypeSupport(new RawType(topic.type, topic.keyed)));
  }

  std::unique_ptr<Entities> entities_;
};

}  // namespace
}  // namespace fastdds

Result<std::unique_ptr<Participant>> make_fastdds_participant(const FastDdsOptions& options) {
  auto entities = fastdds::Entities::make(options);
  if (!entities) return tl::unexpected(entities.error());
  return std::make_unique<fastdds::FastDdsParticipant>(std::move(*entities));
}

Result<std::unique_ptr<RawParticipant>> make_fastdds_raw_participant(
    const FastDdsOptions& options) {
  auto entities = fastdds::Entities::make(options);
  if (!entities) return tl::unexpected(entities.error());
  if (const auto hears = (*entities)->self_check(); !hears) return tl::unexpected(hears.error());
  return std::make_unique<fastdds::FastDdsRawParticipant>(std::move(*entities));
}

}  // namespace swarm::link
