// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

#include "swarm_link/udp_socket.hpp"

/// UDP on one interface whose user-data sockets have no receive thread: the owner drains
/// them from its own tick. The wake-up per datagram is two thirds of what receiving a small sample
/// costs; this removes it. Metatraffic (discovery) stays with the vendor's threads.
namespace swarm::link::fastdds {

/// The receiving sockets of one participant; shared by the transport, which opens them, and the
/// participant, which drains and judges them.
class ReceiveSockets {
 public:
  /// `first_data_port`: data ports are this one and every second one above it (the vendor's rule
  /// for finding a free port adds 2). Zero: every port stays with the vendor.
  ReceiveSockets(std::uint16_t first_data_port, bool at_tick, int buffer_bytes,
                 const std::string& interface = kLoopback, const ReceptionFaults& faults = {});
  ~ReceiveSockets();
  ReceiveSockets(const ReceiveSockets&) = delete;
  ReceiveSockets& operator=(const ReceiveSockets&) = delete;

  bool is_data_port(std::uint32_t port) const;

  using Receiver = eprosima::fastdds::rtps::TransportReceiverInterface;
  using Locator = eprosima::fastdds::rtps::Locator;
  /// Data ports and multicast groups are ours when drained at the tick.
  bool owns(const Locator& locator) const;
  bool open(const Locator& locator, Receiver* receiver);
  bool close(const Locator& locator);
  bool is_open(const Locator& locator) const;

  /// Hears what is sent to a multicast group, until as many calls of leave(). The vendor opens a
  /// group's socket with its first reader and keeps it for ever: membership decides whether
  /// anything arrives. Fails when the socket is not open or the kernel refuses.
  bool join(const Locator& group);
  void leave(const Locator& group);

  /// Remembers that the vendor's transport opened or closed a port.
  void note_opened(std::uint32_t port);

  /// Hands waiting datagrams to the vendor.
  void drain();

  /// What is sent while silent is lost.
  void set_silent(bool silent) { silent_ = silent; }
  bool silent() const { return silent_; }

  bool can_receive_data() const;
  bool can_receive_metatraffic() const;
  bool can_receive(std::uint32_t port) const;

 private:
  struct Socket {
    int fd;
    Locator locator;
    Receiver* receiver;
    int members = 0;  // readers of a multicast group; 0: not joined
  };
  Socket* find(const Locator& locator);
  const Socket* find(const Locator& locator) const;
  std::uint16_t first_data_port_;
  bool at_tick_;
  int buffer_bytes_;
  in_addr interface_;
  mutable std::mutex mutex_;
  std::vector<Socket> sockets_;
  std::vector<std::uint32_t> opened_;
  std::optional<DatagramDrain> drain_;  // of owned sockets
  std::atomic<bool> silent_ = false;
};

/// The vendor's locator of a UDP address, and back.
eprosima::fastdds::rtps::Locator to_locator(const sockaddr_in& address);
sockaddr_in to_address(const eprosima::fastdds::rtps::Locator& locator);

/// The vendor's own UDP transport, bound to one interface.
std::shared_ptr<eprosima::fastdds::rtps::UDPv4TransportDescriptor> udp_on(
    const std::string& interface, int buffer_bytes);

struct LoopbackTransportDescriptor : eprosima::fastdds::rtps::ChainingTransportDescriptor {
  explicit LoopbackTransportDescriptor(std::shared_ptr<ReceiveSockets> receive_sockets,
                                       const std::string& interface, int buffer_bytes);
  eprosima::fastdds::rtps::TransportInterface* create_transport() const override;

  std::shared_ptr<ReceiveSockets> sockets;
};

}  // namespace swarm::link::fastdds
