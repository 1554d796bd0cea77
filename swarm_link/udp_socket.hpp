// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <netinet/in.h>

#include "swarm_link/channels/faulty_path.hpp"

/// UDP on one interface: what the Fast DDS back and the groups share. No vendor's types. Interfaces
/// are named by their IPv4 address.
namespace swarm::link {

inline constexpr const char* kLoopback = "127.0.0.1";

/// 127.0.0.1 if the text is no IPv4 address.
in_addr to_in_addr(const std::string& address);

bool is_multicast(const in_addr& address);

/// Group 239.255.h.h of a DDS domain, at the standard's port for its user multicast.
sockaddr_in multicast_group(std::uint32_t domain, std::uint32_t hash);

/// A non-blocking socket bound to an address; −1 if the kernel refuses. A multicast group's socket
/// is bound to the group, so it receives nothing else, and shares its port with other processes; it
/// receives nothing at all until join_group(). Others share theirs if `shared`.
int open_receive_socket(const sockaddr_in& address, int buffer_bytes, bool shared = false);

bool join_group(int fd, const in_addr& group, const in_addr& interface);
bool leave_group(int fd, const in_addr& group, const in_addr& interface);

/// A non-blocking socket that sends to multicast groups on an interface; −1 if refused.
int open_group_sender(const in_addr& interface);

/// Sends a datagram to a multicast group and looks whether it comes back.
bool carries_multicast(const std::string& interface = kLoopback);

/// Receive buffer the kernel really grants when `asked_bytes` are asked for.
int granted_receive_buffer_bytes(int asked_bytes);

/// Empties sockets without waiting.
class DatagramDrain {
 public:
  explicit DatagramDrain(const ReceptionFaults& faults = {});

  /// At most kMaxDatagrams, so that a flood cannot hold the tick.
  static constexpr int kMaxDatagrams = 8192;
  void drain(int fd, DatagramSink& sink);

 private:
  int drain_batch(int fd, DatagramSink& sink);
  std::optional<FaultyPath> path_;
  std::unique_ptr<std::byte[]> buffers_;  // untouched pages cost nothing
};

}  // namespace swarm::link
