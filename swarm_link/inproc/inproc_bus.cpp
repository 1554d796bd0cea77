// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/inproc/inproc_bus.hpp"

#include <map>
#include <string>
#include <tuple>

#include "swarm_link/inproc/inproc_channel.hpp"
#include "swarm_link/typed_participant.hpp"

namespace swarm::link {

using inproc::Channel;

// Channels live as long as their endpoints: cell topics come and go.
struct InprocBus::Impl {
  template <class M>
  using Channels = std::map<std::string, std::weak_ptr<Channel<M>>>;

  template <class M>
  std::shared_ptr<Channel<M>> channel(const std::string& name) {
    auto& channels = std::get<Channels<M>>(all);
    auto& entry = channels[name];
    auto channel = entry.lock();
    if (!channel) {
      channel = std::make_shared<Channel<M>>();
      entry = channel;
      std::erase_if(channels, [](const auto& other) { return other.second.expired(); });
    }
    return channel;
  }

  std::tuple<Channels<PlanMessage>, Channels<SceneMessage>, Channels<HeartbeatMessage>,
             Channels<CellStatesMessage>, Channels<CommandMessage>, Channels<StatusMessage>,
             Channels<EventMessage>>
      all;
};

namespace {

template <class Impl>
class InprocParticipant final : public TypedParticipant<InprocParticipant<Impl>> {
 public:
  InprocParticipant(Impl& bus, std::uint32_t strength) : bus_(bus), strength_(strength) {}

  void receive() override {}
  Result<void> self_check() const override { return {}; }

 private:
  friend class TypedParticipant<InprocParticipant>;
  template <class M>
  WriterPtr<M> writer(const Topic<M>& topic) {
    return std::make_unique<inproc::InprocWriter<M>>(bus_.template channel<M>(topic.name),
                                                     topic.qos, strength_);
  }
  template <class M>
  ReaderPtr<M> reader(const Topic<M>& topic) {
    return std::make_unique<inproc::InprocReader<M>>(bus_.template channel<M>(topic.name),
                                                     topic.qos);
  }

  Impl& bus_;
  std::uint32_t strength_;
};

}  // namespace

InprocBus::InprocBus() : impl_(std::make_unique<Impl>()) {}
InprocBus::~InprocBus() = default;

std::unique_ptr<Participant> InprocBus::make_participant(std::uint32_t ownership_strength) {
  return std::make_unique<InprocParticipant<Impl>>(*impl_, ownership_strength);
}

}  // namespace swarm::link
