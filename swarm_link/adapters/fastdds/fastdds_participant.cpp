// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/adapters/fastdds/fastdds_participant.hpp"

#include <exception>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "swarm_link/adapters/fastdds/endpoints.hpp"
#include "swarm_link/adapters/fastdds/entities.hpp"
#include "swarm_link/adapters/fastdds/entity_qos.hpp"
#include "swarm_link/udp_socket.hpp"

namespace swarm::link {
namespace fastdds {
namespace {

/// Converts exceptions of the vendor to errors.
template <class Make>
auto guarded(const char* kind, const std::string& topic, Make make) -> decltype(make()) {
  try {
    return make();
  } catch (const std::exception& e) {
    return fail(ErrorCode::kEnvironment, fmt::format("{} of '{}': {}", kind, topic, e.what()));
  }
}

// The adapter's implementation of Participant.
class FastDdsParticipant final : public Participant {
 public:
  explicit FastDdsParticipant(std::unique_ptr<Entities> entities)
      : entities_(std::move(entities)) {}

  Result<RawWriterPtr> make_writer(const RawTopic& topic) override {
    return guarded("writer", topic.name, [&]() -> Result<RawWriterPtr> {
      register_type(topic);
      const auto made = entities_->make_writer(topic.name, topic.type, topic.qos);
      if (!made) return tl::unexpected(made.error());
      return std::make_unique<FastDdsWriter>(entities_->publisher(), *made, entities_->topics(),
                                             topic.name);
    });
  }

  Result<RawReaderPtr> make_reader(const RawTopic& topic) override {
    return guarded("reader", topic.name, [&]() -> Result<RawReaderPtr> {
      register_type(topic);
      // A topic with many readers is received by multicast: one datagram reaches all of them.
      std::optional<eprosima::fastrtps::rtps::Locator_t> group;
      if (topic.qos.many_readers && multicast_)
        group = group_of(entities_->options().domain, topic.name);
      const auto made = entities_->make_reader(topic.name, topic.type, topic.qos, group);
      if (!made) return tl::unexpected(made.error());
      auto membership =
          group ? std::make_unique<GroupMembership>(entities_->sockets(), *group) : nullptr;
      const bool cannot_receive = membership && !membership->joined();
      auto reader = std::make_unique<FastDdsReader>(
          entities_->subscriber(), *made, entities_->topics(), topic.name, std::move(membership));
      if (cannot_receive) {
        return fail(ErrorCode::kEnvironment,
                    fmt::format("reader of '{}' cannot join a multicast group", topic.name));
      }
      return reader;
    });
  }

  void receive() override { entities_->receive(); }

  Result<void> self_check() const override { return entities_->self_check(); }

 private:
  // The vendor accepts a type only once per participant.
  void register_type(const RawTopic& topic) {
    if (!types_.insert(topic.type).second) return;
    entities_->register_type(eprosima::fastdds::dds::TypeSupport(new RawType(topic)));
  }

  std::unique_ptr<Entities> entities_;
  std::set<std::string> types_;  // registered so far
  bool multicast_ = !entities_->options().open && entities_->options().receive_at_tick &&
                    entities_->options().cells_by_multicast &&
                    carries_multicast(entities_->options().interface);  // else by unicast
};

}  // namespace
}  // namespace fastdds

Result<std::unique_ptr<Participant>> make_fastdds_participant(const FastDdsOptions& options) {
  auto entities = fastdds::Entities::make(options);
  if (!entities) return tl::unexpected(entities.error());
  return std::make_unique<fastdds::FastDdsParticipant>(std::move(*entities));
}

}  // namespace swarm::link
