// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/inproc/inproc_bus.hpp"

#include <map>
#include <string>
#include <utility>

#include "tests/support/inproc/inproc_channel.hpp"

namespace swarm::link {

using inproc::Channel;

struct InprocBus::Impl {
  /// The endpoints of a topic, by name and type. Endpoints own their channel, so it is deleted with
  /// the last one: cell topics come and go. Expired entries are removed on the occasion.
  std::shared_ptr<Channel> channel(const RawTopic& topic) {
    auto& entry = channels[{topic.name, topic.type}];
    auto channel = entry.lock();
    if (!channel) {
      channel = std::make_shared<Channel>();
      entry = channel;
      std::erase_if(channels, [](const auto& other) { return other.second.expired(); });
    }
    return channel;
  }

  std::map<std::pair<std::string, std::string>, std::weak_ptr<Channel>> channels;
  std::uint64_t participants = 0;
};

namespace {

// Makes endpoints on the channels of a bus; its writers share one number.
template <class Impl>
class InprocParticipant final : public Participant {
 public:
  explicit InprocParticipant(Impl& bus) : bus_(bus), sender_(++bus.participants) {}

  Result<RawWriterPtr> make_writer(const RawTopic& topic) override {
    return std::make_unique<inproc::InprocWriter>(bus_.channel(topic), topic, sender_);
  }
  Result<RawReaderPtr> make_reader(const RawTopic& topic) override {
    return std::make_unique<inproc::InprocReader>(bus_.channel(topic), topic.qos);
  }

  void receive() override {}
  Result<void> self_check() const override { return {}; }

 private:
  Impl& bus_;
  std::uint64_t sender_;
};

}  // namespace

InprocBus::InprocBus() : impl_(std::make_unique<Impl>()) {}
InprocBus::~InprocBus() = default;

std::unique_ptr<Participant> InprocBus::make_participant() {
  return std::make_unique<InprocParticipant<Impl>>(*impl_);
}

}  // namespace swarm::link
