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

#include "swarm_link/socket_set.hpp"
#include "swarm_link/udp_socket.hpp"

/// UDP on one interface without a receive thread for user data: the owner drains those sockets from
/// its own tick. Waking a thread for every datagram is two thirds of the cost of receiving a small
/// sample; this transport avoids it. Discovery traffic (metatraffic) stays with the vendor's
/// threads.
namespace swarm::link::fastdds {

/// The receiving sockets of one participant, shared by the transport, which opens them, and the
/// participant, which drains and checks them. Thread-safe: a mutex guards the list, because the
/// vendor opens and closes sockets from its own threads.
class ReceiveSockets {
 public:
  /// `first_data_port`: data ports are this one and every second one above it (the vendor's rule
  /// for finding a free port adds 2). Zero: every port stays with the vendor.
  ReceiveSockets(std::uint16_t first_data_port, bool at_tick, int buffer_bytes,
                 const std::string& interface = kLoopback, const ReceptionFaults& faults = {});
  ~ReceiveSockets();
  ReceiveSockets(const ReceiveSockets&) = delete;
  ReceiveSockets& operator=(const ReceiveSockets&) = delete;

  /// Whether a port carries user data; the ports in between carry metatraffic.
  bool is_data_port(std::uint32_t port) const;

  using Receiver = eprosima::fastdds::rtps::TransportReceiverInterface;
  using Locator = eprosima::fastdds::rtps::Locator;
  /// Whether this class receives at the locator instead of the vendor: data ports and multicast
  /// groups, if they are drained at the tick.
  bool owns(const Locator& locator) const;
  /// Opens a socket whose datagrams go to the vendor's `receiver`. False if the kernel refuses.
  bool open(const Locator& locator, Receiver* receiver);
  bool close(const Locator& locator);
  bool is_open(const Locator& locator) const;

  /// Joins a multicast group until the same number of leave() calls. The vendor opens a group's
  /// socket with its first reader and never closes it, so membership decides whether anything
  /// arrives. Fails when the socket is not open or the kernel refuses.
  bool join(const Locator& group);
  void leave(const Locator& group);

  /// Records that the vendor's transport opened a port, for the can_receive functions.
  void note_opened(std::uint32_t port);

  /// Hands waiting datagrams to the vendor, in the caller's thread.
  void drain();

  /// While silent, everything the participant sends is discarded.
  void set_silent(bool silent) { silent_ = silent; }
  bool silent() const { return silent_; }

  /// Whether the participant got at least one data port, one metatraffic port, this very port.
  bool can_receive_data() const;
  bool can_receive_metatraffic() const;
  bool can_receive(std::uint32_t port) const;

 private:
  /// An open socket and the vendor's object that its datagrams are delivered to.
  struct Socket {
    int fd;
    Locator locator;  ///< as the vendor knows it
    Receiver* receiver;
    int members = 0;  // readers of a multicast group; 0: not joined
  };
  Socket* find(const Locator& locator);
  const Socket* find(const Locator& locator) const;
  std::uint16_t first_data_port_;  ///< 0: the vendor receives everything
  bool at_tick_;                   ///< false: the vendor's threads receive data, too
  int buffer_bytes_;               ///< of each socket
  in_addr interface_;              ///< joins groups there
  mutable std::mutex mutex_;
  std::vector<Socket> sockets_;         ///< data ports and groups
  SocketSet set_;                       ///< of these
  std::vector<std::uint32_t> opened_;   ///< ports, also the vendor's
  std::optional<DatagramDrain> drain_;  // of owned sockets
  std::atomic<bool> silent_ = false;
};

/// The vendor's locator of a UDP address, and back.
eprosima::fastdds::rtps::Locator to_locator(const sockaddr_in& address);
sockaddr_in to_address(const eprosima::fastdds::rtps::Locator& locator);

/// The vendor's own UDP transport, bound to one interface.
std::shared_ptr<eprosima::fastdds::rtps::UDPv4TransportDescriptor> udp_on(
    const std::string& interface, int buffer_bytes);

/// Makes the transport: the vendor's UDP for sending and metatraffic, `sockets` for data.
struct LoopbackTransportDescriptor : eprosima::fastdds::rtps::ChainingTransportDescriptor {
  explicit LoopbackTransportDescriptor(std::shared_ptr<ReceiveSockets> receive_sockets,
                                       const std::string& interface, int buffer_bytes);
  eprosima::fastdds::rtps::TransportInterface* create_transport() const override;

  std::shared_ptr<ReceiveSockets> sockets;
};

}  // namespace swarm::link::fastdds
