// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <netinet/in.h>

#include "swarm_core/mission/link_faults.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::link {

/// A simulated degraded network for what one process receives. Needs no root and no kernel support.
struct ReceptionFaults {
  LinkFaults faults{};     ///< loss, delay and jitter, and when
  std::uint64_t seed = 0;  ///< of this process; decides which datagrams are lost
  UtcTime run_began{};     ///< the times in `faults` count from here
};

/// Receives datagrams from a drain. The bytes are valid during the call and may be modified.
class DatagramSink {
 public:
  virtual ~DatagramSink() = default;
  virtual void datagram(std::span<std::byte> bytes, const sockaddr_in& sender) = 0;
};

/// Discards datagrams, delivers them late or twice. The outcome of the n-th datagram that a process
/// receives while faults are active depends only on n and the seed. Not thread-safe.
class FaultyPath {
 public:
  explicit FaultyPath(const ReceptionFaults& reception) : reception_(reception) {}

  /// Stores a datagram that arrived at a socket at time `at`, or discards it.
  void receive(int fd, std::span<const std::byte> bytes, const sockaddr_in& sender, UtcTime at);

  /// Delivers the datagrams of this socket that are due, in the order of their due times.
  void hand_due(int fd, UtcTime now, DatagramSink& sink);

 private:
  /// When the queue is full, further datagrams are lost, as in a router. The size corresponds to
  /// one second of the traffic of the busiest process.
  static constexpr std::size_t kMostKept = 8192;
  /// Datagrams that are overdue by this much belong to a socket that was closed: they are deleted.
  static constexpr Duration kAbandoned = std::chrono::seconds(5);

  void keep(UtcTime due, int fd, std::span<const std::byte> bytes, const sockaddr_in& sender);

  /// A datagram that waits for its delivery time.
  struct Late {
    UtcTime due;
    int fd;
    sockaddr_in sender;
    std::vector<std::byte> bytes;
  };

  ReceptionFaults reception_;
  std::uint64_t received_ = 0;
  std::vector<Late> late_;  // sorted by due
};

}  // namespace swarm::link
