// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/fastdds/group_transport.hpp"

#include <exception>

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <sys/socket.h>
#include <unistd.h>

#include "swarm_link/fastdds/loopback_transport.hpp"

namespace swarm::link::fastdds {

namespace rtps = eprosima::fastdds::rtps;
using eprosima::fastrtps::rtps::LocatorsIterator;
using eprosima::fastrtps::rtps::SenderResource;
using eprosima::fastrtps::rtps::octet;

namespace {

sockaddr_in address_of(const in_addr& group, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr = group;
  return address;
}

/// Sends to the group the sockets are aimed at, whatever the vendor's list of locators says.
class GroupSender final : public SenderResource {
 public:
  explicit GroupSender(std::shared_ptr<GroupSockets> sockets) : SenderResource(LOCATOR_KIND_UDPv4) {
    send_lambda_ = [sockets = std::move(sockets)](
                       const octet* bytes, std::uint32_t size, LocatorsIterator*, LocatorsIterator*,
                       const std::chrono::steady_clock::time_point&) {
      return sockets->send(bytes, size);
    };
  }
};

class GroupTransport final : public rtps::ChainingTransport {
 public:
  explicit GroupTransport(const GroupTransportDescriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor) {}

  rtps::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  bool IsInputChannelOpen(const rtps::Locator& locator) const override {
    return locator.port == GroupTransportDescriptor::kDataPort ? data_open_ : metatraffic_open_;
  }

  bool OpenInputChannel(const rtps::Locator& locator, rtps::TransportReceiverInterface* receiver,
                        std::uint32_t) override {
    const bool data = locator.port == GroupTransportDescriptor::kDataPort;
    (data ? data_open_ : metatraffic_open_) = true;
    if (data) descriptor_.sockets->set_receiver(receiver);
    return true;
  }

  bool CloseInputChannel(const rtps::Locator& locator) override {
    const bool data = locator.port == GroupTransportDescriptor::kDataPort;
    (data ? data_open_ : metatraffic_open_) = false;
    if (data) descriptor_.sockets->set_receiver(nullptr);
    return true;
  }

  bool OpenOutputChannel(rtps::SendResourceList& senders, const rtps::Locator&) override {
    if (senders.empty()) senders.push_back(std::make_unique<GroupSender>(descriptor_.sockets));
    return true;
  }

  // Never called: neither direction is wrapped.
  bool send(SenderResource*, const octet*, std::uint32_t, LocatorsIterator*, LocatorsIterator*,
            const std::chrono::steady_clock::time_point&) override {
    return false;
  }
  void receive(rtps::TransportReceiverInterface*, const octet*, std::uint32_t, const rtps::Locator&,
               const rtps::Locator&) override {}

 private:
  GroupTransportDescriptor descriptor_;
  bool data_open_ = false;
  bool metatraffic_open_ = false;
};

}  // namespace

GroupSockets::GroupSockets(int buffer_bytes)
    : buffer_bytes_(buffer_bytes), sender_(open_group_sender()) {}

GroupSockets::~GroupSockets() {
  for (const auto& [group, fd] : sockets_) ::close(fd);
  if (sender_ >= 0) ::close(sender_);
}

void GroupSockets::aim(const in_addr& group, std::uint16_t port) {
  target_ = address_of(group, port);
}

bool GroupSockets::send(const void* bytes, std::size_t size) {
  return ::sendto(sender_, bytes, size, 0, reinterpret_cast<const sockaddr*>(&target_),
                  sizeof target_) == static_cast<ssize_t>(size);
}

bool GroupSockets::join(const in_addr& group, std::uint16_t port) {
  if (sockets_.contains(group.s_addr)) return true;
  const int fd = open_receive_socket(address_of(group, port), buffer_bytes_);
  if (fd < 0) return false;
  if (!join_group(fd, group)) {
    ::close(fd);
    return false;
  }
  sockets_.emplace(group.s_addr, fd);
  return true;
}

void GroupSockets::leave(const in_addr& group) {
  const auto known = sockets_.find(group.s_addr);
  if (known == sockets_.end()) return;
  ::close(known->second);  // and with it the membership
  sockets_.erase(known);
}

void GroupSockets::drain() {
  if (receiver_ == nullptr) return;
  for (const auto& [group, fd] : sockets_) drain_.drain(fd, *this);
}

void GroupSockets::datagram(std::span<std::byte> bytes, const sockaddr_in& sender) {
  rtps::Locator here;
  here.kind = LOCATOR_KIND_UDPv4;
  here.port = GroupTransportDescriptor::kDataPort;
  try {
    receiver_->OnDataReceived(reinterpret_cast<const octet*>(bytes.data()),
                              static_cast<std::uint32_t>(bytes.size()), here, to_locator(sender));
  } catch (const std::exception&) {
    // The vendor choked on one datagram: as good as lost.
  }
}

GroupTransportDescriptor::GroupTransportDescriptor(std::shared_ptr<GroupSockets> group_sockets)
    : ChainingTransportDescriptor(loopback_udp(0)), sockets(std::move(group_sockets)) {}

rtps::TransportInterface* GroupTransportDescriptor::create_transport() const {
  return new GroupTransport(*this);
}

}  // namespace swarm::link::fastdds
