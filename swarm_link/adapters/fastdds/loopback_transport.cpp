// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/adapters/fastdds/loopback_transport.hpp"

#include <algorithm>
#include <cstring>
#include <exception>

#include <fastrtps/utils/IPLocator.h>
#include <unistd.h>

namespace swarm::link::fastdds {

namespace rtps = eprosima::fastdds::rtps;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::octet;

sockaddr_in to_address(const rtps::Locator& locator) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(IPLocator::getPhysicalPort(locator));
  std::memcpy(&address.sin_addr.s_addr, IPLocator::getIPv4(locator), sizeof address.sin_addr);
  return address;
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

// Without the white list the vendor would open its sockets on all interfaces.
std::shared_ptr<rtps::UDPv4TransportDescriptor> udp_on(const std::string& interface,
                                                       int buffer_bytes) {
  auto udp = std::make_shared<rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = {interface};
  udp->receiveBufferSize = static_cast<std::uint32_t>(buffer_bytes);
  udp->sendBufferSize = static_cast<std::uint32_t>(buffer_bytes);
  return udp;
}

namespace {

// Unicast locators are equal by port, because each socket is bound to the one interface; groups
// also by address, because all groups of a domain share a port.
bool same_channel(const rtps::Locator& a, const rtps::Locator& b) {
  const bool multicast = IPLocator::isMulticast(a);
  return a.port == b.port && multicast == IPLocator::isMulticast(b) &&
         (!multicast || to_address(a).sin_addr.s_addr == to_address(b).sin_addr.s_addr);
}

// Wraps the vendor's UDP transport. Receiving from data ports and groups goes to ReceiveSockets,
// everything else to the vendor's transport.
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
    // Directly to the lower transport: its datagrams need no processing by this one.
    const bool opened = low_level_transport_->OpenInputChannel(locator, receiver, max_message_size);
    if (opened) sockets().note_opened(locator.port);
    return opened;
  }

  bool CloseInputChannel(const rtps::Locator& locator) override {
    if (sockets().owns(locator)) return sockets().close(locator);
    return low_level_transport_->CloseInputChannel(locator);
  }

  // Reports success while silent, so that the vendor does not log errors.
  bool send(eprosima::fastrtps::rtps::SenderResource* socket, const octet* bytes,
            std::uint32_t size, eprosima::fastrtps::rtps::LocatorsIterator* begin,
            eprosima::fastrtps::rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& deadline) override {
    if (sockets().silent()) return true;
    return socket->send(bytes, size, begin, end, deadline);
  }

  // Never called, because received datagrams do not pass this transport (see OpenInputChannel).
  void receive(rtps::TransportReceiverInterface*, const octet*, std::uint32_t, const rtps::Locator&,
               const rtps::Locator&) override {}

 private:
  ReceiveSockets& sockets() const { return *descriptor_.sockets; }

  LoopbackTransportDescriptor descriptor_;
};

}  // namespace

ReceiveSockets::ReceiveSockets(std::uint16_t first_data_port, bool at_tick, int buffer_bytes,
                               const std::string& interface, const ReceptionFaults& faults)
    : first_data_port_(first_data_port),
      at_tick_(at_tick),
      buffer_bytes_(buffer_bytes),
      interface_(to_in_addr(interface)) {
  if (at_tick_) drain_.emplace(faults);
}

ReceiveSockets::~ReceiveSockets() {
  for (const auto& socket : sockets_) ::close(socket.fd);
}

// The vendor adds 2 to a port that is taken, so parity distinguishes data from metatraffic ports.
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

// A unicast locator may carry any address of the host: the socket is bound to our interface.
bool ReceiveSockets::open(const Locator& locator, Receiver* receiver) {
  sockaddr_in address = to_address(locator);
  if (!is_multicast(address.sin_addr)) address.sin_addr = interface_;
  const int fd = open_receive_socket(address, buffer_bytes_);
  if (fd < 0) return false;
  const std::lock_guard lock(mutex_);
  sockets_.push_back({.fd = fd, .locator = locator, .receiver = receiver});
  set_.add(fd);
  if (is_data_port(locator.port)) opened_.push_back(locator.port);
  return true;
}

bool ReceiveSockets::close(const Locator& locator) {
  const std::lock_guard lock(mutex_);
  const Socket* const socket = find(locator);
  if (socket == nullptr) return false;
  set_.remove(socket->fd);
  ::close(socket->fd);
  sockets_.erase(sockets_.begin() + (socket - sockets_.data()));
  return true;
}

// Readers of one group share its socket: only the first one joins in the kernel.
bool ReceiveSockets::join(const Locator& group) {
  const std::lock_guard lock(mutex_);
  Socket* const socket = find(group);
  if (socket == nullptr) return false;
  if (socket->members == 0 && !join_group(socket->fd, to_address(group).sin_addr, interface_)) {
    return false;
  }
  ++socket->members;
  return true;
}

void ReceiveSockets::leave(const Locator& group) {
  const std::lock_guard lock(mutex_);
  Socket* const socket = find(group);
  if (socket == nullptr || socket->members == 0) return;
  if (--socket->members == 0) leave_group(socket->fd, to_address(group).sin_addr, interface_);
}

bool ReceiveSockets::is_open(const Locator& locator) const {
  const std::lock_guard lock(mutex_);
  return find(locator) != nullptr;
}

void ReceiveSockets::note_opened(std::uint32_t port) {
  const std::lock_guard lock(mutex_);
  opened_.push_back(port);
}

// Runs in the owner's thread and calls the vendor's receive function for each datagram. The mutex
// is held throughout, so no socket is closed while it is read.
void ReceiveSockets::drain() {
  struct ToVendor final : DatagramSink {
    const Socket* socket = nullptr;
    void datagram(std::span<std::byte> bytes, const sockaddr_in& sender) override {
      try {
        socket->receiver->OnDataReceived(reinterpret_cast<const octet*>(bytes.data()),
                                         static_cast<std::uint32_t>(bytes.size()), socket->locator,
                                         to_locator(sender));
      } catch (const std::exception&) {
        // The vendor threw on a malformed datagram: treated as lost.
      }
    }
  } to_vendor;
  const std::lock_guard lock(mutex_);
  for (const int fd : drain_->to_read(set_)) {
    to_vendor.socket = &*std::ranges::find(sockets_, fd, &Socket::fd);
    drain_->drain(fd, to_vendor);
  }
}

bool ReceiveSockets::can_receive_data() const {
  const std::lock_guard lock(mutex_);
  return std::any_of(opened_.begin(), opened_.end(), [&](auto port) { return is_data_port(port); });
}

bool ReceiveSockets::can_receive_metatraffic() const {
  const std::lock_guard lock(mutex_);
  return std::any_of(opened_.begin(), opened_.end(),
                     [&](auto port) { return !is_data_port(port); });
}

bool ReceiveSockets::can_receive(std::uint32_t port) const {
  const std::lock_guard lock(mutex_);
  return std::find(opened_.begin(), opened_.end(), port) != opened_.end();
}

LoopbackTransportDescriptor::LoopbackTransportDescriptor(
    std::shared_ptr<ReceiveSockets> receive_sockets, const std::string& interface, int buffer_bytes)
    : ChainingTransportDescriptor(udp_on(interface, buffer_bytes)),
      sockets(std::move(receive_sockets)) {}

rtps::TransportInterface* LoopbackTransportDescriptor::create_transport() const {
  return new LoopbackTransport(*this);
}

}  // namespace swarm::link::fastdds
