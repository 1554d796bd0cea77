// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/fastdds/loopback_transport.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>

#include <arpa/inet.h>
#include <fastrtps/utils/IPLocator.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace swarm::link::fastdds {

namespace rtps = eprosima::fastdds::rtps;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::octet;

namespace {

constexpr std::size_t kDatagramBytes = 65'536;
constexpr std::size_t kBatch = 32;
constexpr const char* kLoopback = "127.0.0.1";

in_addr group_of(const rtps::Locator& locator) {
  in_addr group{};
  std::memcpy(&group.s_addr, IPLocator::getIPv4(locator), sizeof group.s_addr);
  return group;
}

// A group's socket is bound to the group, not to every address: it hears nothing else.
sockaddr_in to_address(const rtps::Locator& locator) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(IPLocator::getPhysicalPort(locator));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (IPLocator::isMulticast(locator)) address.sin_addr = group_of(locator);
  return address;
}

bool same_channel(const rtps::Locator& a, const rtps::Locator& b) {
  const bool multicast = IPLocator::isMulticast(a);
  return a.port == b.port && multicast == IPLocator::isMulticast(b) &&
         (!multicast || group_of(a).s_addr == group_of(b).s_addr);
}

bool set_membership(int fd, int option, const rtps::Locator& group) {
  ip_mreqn request{};
  request.imr_multiaddr = group_of(group);
  request.imr_address.s_addr = htonl(INADDR_LOOPBACK);
  return ::setsockopt(fd, IPPROTO_IP, option, &request, sizeof request) == 0;
}

rtps::Locator to_locator(const sockaddr_in& address) {
  rtps::Locator locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  locator.port = ntohs(address.sin_port);
  const auto ip = ntohl(address.sin_addr.s_addr);
  IPLocator::setIPv4(locator, static_cast<octet>(ip >> 24U), static_cast<octet>(ip >> 16U),
                     static_cast<octet>(ip >> 8U), static_cast<octet>(ip));
  return locator;
}

class LoopbackTransport final : public rtps::ChainingTransport {
 public:
  explicit LoopbackTransport(const LoopbackTransportDescriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor) {}

  rtps::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  bool IsInputChannelOpen(const rtps::Locator& locator) const override {
    if (sockets().owns(locator)) return sockets().is_open(locator);
    return low_level_transport_->IsInputChannelOpen(locator);
  }

  bool OpenInputChannel(const rtps::Locator& locator, rtps::TransportReceiverInterface* receiver,
                        std::uint32_t max_message_size) override {
    if (sockets().owns(locator)) return sockets().open(locator, receiver);
    // Straight to the low level: nothing is to be done to the bytes on their way.
    const bool opened = low_level_transport_->OpenInputChannel(locator, receiver, max_message_size);
    if (opened) sockets().note_opened(locator.port);
    return opened;
  }

  bool CloseInputChannel(const rtps::Locator& locator) override {
    if (sockets().owns(locator)) return sockets().close(locator);
    return low_level_transport_->CloseInputChannel(locator);
  }

  bool OpenOutputChannel(rtps::SendResourceList& senders, const rtps::Locator& locator) override {
    return low_level_transport_->OpenOutputChannel(senders, locator);
  }

  // Never called: neither direction is wrapped (see OpenInputChannel and OpenOutputChannel).
  bool send(eprosima::fastrtps::rtps::SenderResource*, const octet*, std::uint32_t,
            eprosima::fastrtps::rtps::LocatorsIterator*,
            eprosima::fastrtps::rtps::LocatorsIterator*,
            const std::chrono::steady_clock::time_point&) override {
    return false;
  }
  void receive(rtps::TransportReceiverInterface*, const octet*, std::uint32_t, const rtps::Locator&,
               const rtps::Locator&) override {}

 private:
  ReceiveSockets& sockets() const { return *descriptor_.sockets; }

  LoopbackTransportDescriptor descriptor_;
};

std::shared_ptr<rtps::UDPv4TransportDescriptor> loopback_udp(int buffer_bytes) {
  auto udp = std::make_shared<rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = {kLoopback};
  udp->receiveBufferSize = static_cast<std::uint32_t>(buffer_bytes);
  udp->sendBufferSize = static_cast<std::uint32_t>(buffer_bytes);
  return udp;
}

}  // namespace

ReceiveSockets::ReceiveSockets(std::uint16_t first_data_port, bool at_tick, int buffer_bytes)
    : first_data_port_(first_data_port), at_tick_(at_tick), buffer_bytes_(buffer_bytes) {
  if (at_tick_) buffers_.reset(new unsigned char[kBatch * kDatagramBytes]);
}

ReceiveSockets::~ReceiveSockets() {
  for (const auto& socket : sockets_) ::close(socket.fd);
}

bool ReceiveSockets::is_data_port(std::uint32_t port) const {
  return first_data_port_ != 0 && port >= first_data_port_ && (port - first_data_port_) % 2 == 0;
}

bool ReceiveSockets::owns(const Locator& locator) const {
  return at_tick_ && (IPLocator::isMulticast(locator) || is_data_port(locator.port));
}

ReceiveSockets::Socket* ReceiveSockets::find(const Locator& locator) {
  const auto it = std::find_if(sockets_.begin(), sockets_.end(),
                               [&](const Socket& s) { return same_channel(s.locator, locator); });
  return it == sockets_.end() ? nullptr : &*it;
}

const ReceiveSockets::Socket* ReceiveSockets::find(const Locator& locator) const {
  return const_cast<ReceiveSockets*>(this)->find(locator);
}

bool ReceiveSockets::open(const Locator& locator, Receiver* receiver) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) return false;
  ::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &buffer_bytes_, sizeof buffer_bytes_);
  if (const int yes = 1; IPLocator::isMulticast(locator)) {  // every process listens there
    ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  }
  const auto address = to_address(locator);
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    ::close(fd);
    return false;
  }
  const std::lock_guard lock(mutex_);
  sockets_.push_back({.fd = fd, .locator = locator, .receiver = receiver});
  if (is_data_port(locator.port)) opened_.push_back(locator.port);
  return true;
}

bool ReceiveSockets::close(const Locator& locator) {
  const std::lock_guard lock(mutex_);
  const Socket* const socket = find(locator);
  if (socket == nullptr) return false;
  ::close(socket->fd);
  sockets_.erase(sockets_.begin() + (socket - sockets_.data()));
  return true;
}

bool ReceiveSockets::join(const Locator& group) {
  const std::lock_guard lock(mutex_);
  Socket* const socket = find(group);
  if (socket == nullptr) return false;
  if (socket->members == 0 && !set_membership(socket->fd, IP_ADD_MEMBERSHIP, group)) return false;
  ++socket->members;
  return true;
}

void ReceiveSockets::leave(const Locator& group) {
  const std::lock_guard lock(mutex_);
  Socket* const socket = find(group);
  if (socket == nullptr || socket->members == 0) return;
  if (--socket->members == 0) set_membership(socket->fd, IP_DROP_MEMBERSHIP, group);
}

bool ReceiveSockets::is_open(const Locator& locator) const {
  const std::lock_guard lock(mutex_);
  return find(locator) != nullptr;
}

void ReceiveSockets::note_opened(std::uint32_t port) {
  const std::lock_guard lock(mutex_);
  opened_.push_back(port);
}

void ReceiveSockets::drain() {
  const std::lock_guard lock(mutex_);
  for (const auto& socket : sockets_) {
    for (int received = 0; received < kMaxDatagrams;) {
      const int batch = drain_socket(socket);
      received += batch;
      if (batch < static_cast<int>(kBatch)) break;
    }
  }
}

int ReceiveSockets::drain_socket(const Socket& socket) {
  std::array<mmsghdr, kBatch> messages{};
  std::array<iovec, kBatch> vectors;
  std::array<sockaddr_in, kBatch> senders;
  for (std::size_t i = 0; i < kBatch; ++i) {
    vectors[i] = {buffers_.get() + i * kDatagramBytes, kDatagramBytes};
    messages[i].msg_hdr.msg_iov = &vectors[i];
    messages[i].msg_hdr.msg_iovlen = 1;
    messages[i].msg_hdr.msg_name = &senders[i];
    messages[i].msg_hdr.msg_namelen = sizeof(sockaddr_in);
  }
  const int count = ::recvmmsg(socket.fd, messages.data(), kBatch, MSG_DONTWAIT, nullptr);
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    try {
      socket.receiver->OnDataReceived(buffers_.get() + k * kDatagramBytes, messages[k].msg_len,
                                      socket.locator, to_locator(senders[k]));
    } catch (const std::exception&) {
      continue;  // the vendor choked on one datagram: as good as lost
    }
  }
  return std::max(count, 0);
}

bool ReceiveSockets::hears_data() const {
  const std::lock_guard lock(mutex_);
  return std::any_of(opened_.begin(), opened_.end(), [&](auto port) { return is_data_port(port); });
}

bool ReceiveSockets::hears_metatraffic() const {
  const std::lock_guard lock(mutex_);
  return std::any_of(opened_.begin(), opened_.end(),
                     [&](auto port) { return !is_data_port(port); });
}

bool ReceiveSockets::hears(std::uint32_t port) const {
  const std::lock_guard lock(mutex_);
  return std::find(opened_.begin(), opened_.end(), port) != opened_.end();
}

int granted_receive_buffer_bytes(int asked_bytes) {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return 0;
  int granted = 0;
  socklen_t size = sizeof granted;
  ::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &asked_bytes, sizeof asked_bytes);
  ::getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &granted, &size);
  ::close(fd);
  return granted / 2;  // the kernel reports twice what was asked, for its own bookkeeping
}

bool loopback_carries_multicast() {
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) return false;
  rtps::Locator group;
  group.kind = LOCATOR_KIND_UDPv4;
  IPLocator::setIPv4(group, 239, 255, 0, 0);
  sockaddr_in address = to_address(group);  // port 0: any free one
  socklen_t size = sizeof address;
  const ip_mreqn through_loopback{.imr_multiaddr = {},
                                  .imr_address = {htonl(INADDR_LOOPBACK)},
                                  .imr_ifindex = 0};
  const bool sent =
      ::bind(fd, reinterpret_cast<const sockaddr*>(&address), size) == 0 &&
      ::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0 &&
      set_membership(fd, IP_ADD_MEMBERSHIP, group) &&
      ::setsockopt(fd, IPPROTO_IP, IP_MULTICAST_IF, &through_loopback, sizeof through_loopback) ==
          0 &&
      ::sendto(fd, "?", 1, 0, reinterpret_cast<const sockaddr*>(&address), size) == 1;
  char back = 0;
  const bool heard = sent && ::recv(fd, &back, 1, 0) == 1;  // the loopback delivers while it sends
  ::close(fd);
  return heard;
}

LoopbackTransportDescriptor::LoopbackTransportDescriptor(
    std::shared_ptr<ReceiveSockets> receive_sockets, int buffer_bytes)
    : ChainingTransportDescriptor(loopback_udp(buffer_bytes)),
      sockets(std::move(receive_sockets)) {}

rtps::TransportInterface* LoopbackTransportDescriptor::create_transport() const {
  return new LoopbackTransport(*this);
}

}  // namespace swarm::link::fastdds
