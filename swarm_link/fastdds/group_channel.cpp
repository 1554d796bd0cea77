// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/fastdds/group_channel.hpp"

#include <algorithm>
#include <exception>
#include <utility>
#include <vector>

#include <fastdds/rtps/RTPSDomain.h>
#include <fastdds/rtps/attributes/HistoryAttributes.h>
#include <fastdds/rtps/attributes/RTPSParticipantAttributes.h>
#include <fastdds/rtps/attributes/ReaderAttributes.h>
#include <fastdds/rtps/attributes/WriterAttributes.h>
#include <fastdds/rtps/history/ReaderHistory.h>
#include <fastdds/rtps/history/WriterHistory.h>
#include <fastdds/rtps/participant/RTPSParticipant.h>
#include <fastdds/rtps/reader/RTPSReader.h>
#include <fastdds/rtps/reader/ReaderListener.h>
#include <fastdds/rtps/writer/StatelessWriter.h>
#include <fmt/format.h>

#include "swarm_link/cell_traffic.hpp"
#include "swarm_link/fastdds/group_transport.hpp"
#include "swarm_link/fastdds/guarded_type.hpp"
#include "swarm_link/fastdds/loopback_transport.hpp"
#include "swarm_link/fastdds/participant_qos.hpp"

namespace swarm::link {

namespace fastdds {

namespace rtps = eprosima::fastrtps::rtps;

namespace {

rtps::Locator_t nowhere(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  return to_locator(address);
}

rtps::RTPSParticipantAttributes participant_attributes(
    const std::shared_ptr<GroupSockets>& sockets) {
  rtps::RTPSParticipantAttributes attributes;
  attributes.setName("swarm_groups");
  attributes.useBuiltinTransports = false;
  attributes.userTransports = {std::make_shared<GroupTransportDescriptor>(sockets)};
  attributes.defaultUnicastLocatorList.push_back(nowhere(GroupTransportDescriptor::kDataPort));
  attributes.builtin.metatrafficUnicastLocatorList.push_back(
      nowhere(GroupTransportDescriptor::kMetatrafficPort));
  attributes.builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::NONE;
  attributes.builtin.use_WriterLivelinessProtocol = false;
  attributes.builtin.avoid_builtin_multicast = true;
  attributes.allocation.send_buffers.preallocated_number = 1;
  attributes.allocation.send_buffers.dynamic = true;
  return attributes;
}

rtps::HistoryAttributes one_at_a_time() {
  rtps::HistoryAttributes attributes;
  attributes.memoryPolicy = rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
  attributes.initialReservedCaches = 1;
  return attributes;
}

template <class Endpoint>
void make_best_effort(Endpoint& attributes) {
  attributes.endpoint.reliabilityKind = rtps::BEST_EFFORT;
  attributes.endpoint.durabilityKind = rtps::VOLATILE;
  attributes.endpoint.topicKind = rtps::NO_KEY;
}

class GroupChannel final : public StateChannel, private rtps::ReaderListener {
 public:
  explicit GroupChannel(const GroupChannelOptions& options)
      : options_(options),
        port_(static_cast<std::uint16_t>(7401 + 250 * options.domain)),
        sockets_(std::make_shared<GroupSockets>(options.receive_buffer_bytes)),
        interest_(options.cells),
        batches_(options.cells.cell_size_m),
        writer_history_(one_at_a_time()),
        reader_history_(one_at_a_time()) {}

  ~GroupChannel() override {
    if (participant_ != nullptr) rtps::RTPSDomain::removeRTPSParticipant(participant_);
  }

  Result<void> open() {
    if (!sockets_->can_send() || !loopback_carries_multicast()) {
      return fail(ErrorCode::kEnvironment,
                  "the loopback interface carries no multicast: run 'ip link set lo up', let "
                  "firewalls pass 239.255.0.0/16 on lo, or use --channel topics");
    }
    participant_ = rtps::RTPSDomain::createParticipant(options_.domain,
                                                       participant_attributes(sockets_), nullptr);
    if (participant_ == nullptr) return refused("participant");
    rtps::WriterAttributes writing;
    make_best_effort(writing);
    writing.mode = rtps::SYNCHRONOUS_WRITER;
    writer_ = dynamic_cast<rtps::StatelessWriter*>(
        rtps::RTPSDomain::createRTPSWriter(participant_, writing, &writer_history_));
    if (writer_ == nullptr) return refused("writer");
    // Where it goes is decided by the sockets' aim; without a locator the vendor sends nothing.
    rtps::LocatorList_t anywhere;
    anywhere.push_back(nowhere(GroupTransportDescriptor::kDataPort));
    if (!writer_->set_fixed_locators(anywhere)) return refused("destination");
    rtps::ReaderAttributes reading;
    make_best_effort(reading);
    auto* reader =
        rtps::RTPSDomain::createRTPSReader(participant_, reading, &reader_history_, this);
    if (reader == nullptr) return refused("reader");
    reader->enableMessagesFromUnkownWriters(true);
    return {};
  }

  std::size_t publish(std::span<const RobotStateMessage> states) override {
    std::size_t sent = 0;
    for (const CellStatesMessage& batch : batches_.sort(states)) {
      sockets_->aim(group_of({batch.cell_x, batch.cell_y}), port_);
      if (write(batch)) sent += batch.states.size();
    }
    return sent;
  }

  void listen_around(std::span<const Vec2> positions_m) override {
    const auto wanted = interest_.update(positions_m);
    // Two cells may share a group: leave none that another one still needs.
    std::vector<in_addr_t> groups;
    for (const Cell& cell : wanted) groups.push_back(group_of(cell).s_addr);
    std::sort(groups.begin(), groups.end());
    groups.erase(std::unique(groups.begin(), groups.end()), groups.end());
    std::erase_if(joined_, [&](in_addr_t group) {
      if (std::binary_search(groups.begin(), groups.end(), group)) return false;
      sockets_->leave({group});
      return true;
    });
    for (const in_addr_t group : groups) {
      if (std::binary_search(joined_.begin(), joined_.end(), group)) continue;
      if (!sockets_->join({group}, port_)) continue;  // tried again next time
      joined_.insert(std::upper_bound(joined_.begin(), joined_.end(), group), group);
    }
  }

  std::size_t take(std::vector<CellStatesMessage>& out) override {
    taking_ = &out;
    const auto before = out.size();
    const auto undecodable_before = undecodable_in_thread;
    sockets_->drain();
    undecodable_ += undecodable_in_thread - undecodable_before;
    taking_ = nullptr;
    return out.size() - before;
  }

  std::uint64_t undecodable() const override { return undecodable_; }

 private:
  static tl::unexpected<Error> refused(const char* what) {
    return fail(ErrorCode::kEnvironment, fmt::format("RTPS refused the {} of the groups", what));
  }

  /// 239.255.h.h of the cell; cells may share a group, which costs datagrams, not correctness.
  static in_addr group_of(const Cell& cell) {
    // Different for any two cells up to 181 × 179 apart: 359 · 181 + 179 < 2¹⁶.
    const auto hash = static_cast<std::uint32_t>(cell.x) * 359U + static_cast<std::uint32_t>(cell.y);
    return {htonl(0xEFFF0000U | (hash & 0xFFFFU))};
  }

  bool write(const CellStatesMessage& batch) {
    try {
      if (!to_wire(batch, wire_)) return false;
      auto* change =
          writer_->new_change(type_.getSerializedSizeProvider(&wire_), rtps::ALIVE);
      if (change == nullptr) return false;
      const bool said =
          type_.serialize(&wire_, &change->serializedPayload) && writer_history_.add_change(change);
      if (said) {
        writer_history_.remove_change_g(change);
      } else {
        writer_->release_change(change);
      }
      return said;
    } catch (const std::exception&) {
      return false;
    }
  }

  // Called by drain(), in the thread that takes.
  void onNewCacheChangeAdded(rtps::RTPSReader*, const rtps::CacheChange_t* const change) override {
    auto* received = const_cast<rtps::CacheChange_t*>(change);
    if (taking_ != nullptr && type_.deserialize(&received->serializedPayload, &wire_)) {
      from_wire(wire_, taking_->emplace_back());
    }
    reader_history_.remove_change(received);
  }

  GroupChannelOptions options_;
  std::uint16_t port_;
  std::shared_ptr<GroupSockets> sockets_;
  CellInterest interest_;
  CellBatches batches_;
  std::vector<in_addr_t> joined_;  // sorted
  rtps::WriterHistory writer_history_;
  rtps::ReaderHistory reader_history_;
  rtps::RTPSParticipant* participant_ = nullptr;
  rtps::StatelessWriter* writer_ = nullptr;
  GuardedType<CellStatesMessage> type_;
  wire::CellStates wire_;
  std::vector<CellStatesMessage>* taking_ = nullptr;
  std::uint64_t undecodable_ = 0;
};

}  // namespace
}  // namespace fastdds

Result<std::unique_ptr<StateChannel>> make_group_channel(const GroupChannelOptions& options) {
  try {
    fastdds::set_up_library();
    auto channel = std::make_unique<fastdds::GroupChannel>(options);
    if (const auto opened = channel->open(); !opened) return tl::unexpected(opened.error());
    return channel;
  } catch (const std::exception& e) {
    return fail(ErrorCode::kEnvironment, fmt::format("groups channel: {}", e.what()));
  }
}

}  // namespace swarm::link
