// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>

#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include "swarm_link/fastdds/udp_socket.hpp"

/// UDP multicast on the loopback interface for a participant without discovery: it has no address
/// of its own, joins and leaves groups at will, and is emptied by its owner's tick.
namespace swarm::link::fastdds {

/// The sockets of one participant, shared by the transport and the channel. Used by one thread.
class GroupSockets final : private DatagramDrain::Sink {
 public:
  explicit GroupSockets(int buffer_bytes);
  ~GroupSockets() override;
  GroupSockets(const GroupSockets&) = delete;
  GroupSockets& operator=(const GroupSockets&) = delete;

  bool can_send() const { return sender_ >= 0; }

  /// Datagrams go to this group from now on.
  void aim(const in_addr& group, std::uint16_t port);
  bool send(const void* bytes, std::size_t size);

  /// One socket per group: the kernel then finds a datagram's few listeners by its address (a
  /// socket of many groups makes it look at every listener of the machine), and the limit of 20
  /// groups per socket never matters. False if the kernel refuses; open files are the limit.
  bool join(const in_addr& group, std::uint16_t port);
  void leave(const in_addr& group);

  /// Hands what waits to the vendor's receiver.
  void drain();

  using Receiver = eprosima::fastdds::rtps::TransportReceiverInterface;
  void set_receiver(Receiver* receiver) { receiver_ = receiver; }

 private:
  void datagram(std::span<std::byte> bytes, const sockaddr_in& sender) override;

  int buffer_bytes_;
  int sender_;
  sockaddr_in target_{};
  std::map<in_addr_t, int> sockets_;  // by group
  Receiver* receiver_ = nullptr;
  DatagramDrain drain_;
};

struct GroupTransportDescriptor : eprosima::fastdds::rtps::ChainingTransportDescriptor {
  /// The participant's only locators: names without sockets, one for what users send.
  static constexpr std::uint16_t kMetatrafficPort = 1;
  static constexpr std::uint16_t kDataPort = 2;

  explicit GroupTransportDescriptor(std::shared_ptr<GroupSockets> group_sockets);
  eprosima::fastdds::rtps::TransportInterface* create_transport() const override;

  std::shared_ptr<GroupSockets> sockets;
};

}  // namespace swarm::link::fastdds
