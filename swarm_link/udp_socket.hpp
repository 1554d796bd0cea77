// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <netinet/in.h>

#include "swarm_link/channels/faulty_path.hpp"
#include "swarm_link/socket_set.hpp"

/// UDP on one interface, used by the Fast DDS adapter and the groups; no vendor types. Interfaces
/// are identified by their IPv4 address.
namespace swarm::link {

inline constexpr const char* kLoopback = "127.0.0.1";

/// Parses an IPv4 address; 127.0.0.1 if the text is none.
in_addr to_in_addr(const std::string& address);

bool is_multicast(const in_addr& address);

/// Group 239.255.h.h of a DDS domain, at the standard's port for its user multicast.
sockaddr_in multicast_group(std::uint32_t domain, std::uint32_t hash);

/// A non-blocking socket bound to an address; −1 if the kernel refuses. The socket of a multicast
/// group is bound to the group, so it receives nothing else, and shares its port with other
/// processes; it receives nothing until join_group(). Other sockets share their port if `shared`.
int open_receive_socket(const sockaddr_in& address, int buffer_bytes, bool shared = false);

/// Membership of a socket in a group on an interface. False if the kernel refuses.
bool join_group(int fd, const in_addr& group, const in_addr& interface);
bool leave_group(int fd, const in_addr& group, const in_addr& interface);

/// A non-blocking socket that sends to multicast groups on an interface; −1 if refused.
int open_group_sender(const in_addr& interface);

/// Whether an interface carries multicast: sends a datagram to a group and waits until it arrives,
/// at most 200 ms.
bool carries_multicast(const std::string& interface = kLoopback);

/// Receive buffer that the kernel really grants when `asked_bytes` are requested.
int granted_receive_buffer_bytes(int asked_bytes);

/// Reads sockets until they are empty, without waiting. All of a thread use the same buffers, which
/// are in the processor's cache then after the first one: a sink must not drain sockets itself
/// (asserted). Not thread-safe.
class DatagramDrain {
 public:
  explicit DatagramDrain(const ReceptionFaults& faults = {}) {
    if (faults.faults.any()) path_.emplace(faults);
  }

  /// Most datagrams of a socket and call, so that a flood cannot delay the tick.
  static constexpr int kMaxDatagrams = 8192;
  /// Passes waiting datagrams to the sink, or through the simulated faults if there are any.
  void drain(int fd, DatagramSink& sink);
  /// Those of the sockets that drain() has to read now. Valid until the next call for the set.
  std::span<const int> to_read(SocketSet& sockets) const {
    return path_ ? sockets.all() : sockets.waiting();  // a delayed datagram can be due in any
  }

 private:
  int drain_batch(int fd, DatagramSink& sink);
  std::optional<FaultyPath> path_;  ///< set if faults are simulated
};

}  // namespace swarm::link
