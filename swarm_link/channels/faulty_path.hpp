// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <netinet/in.h>

#include "swarmflow/core/time.hpp"
#include "swarm_core/mission/link_faults.hpp"

namespace swarm::link {

/// A bad network on demand, without root, for what one process receives.
struct ReceptionFaults {
  LinkFaults faults{};
  std::uint64_t seed = 0;  ///< of this process
  UtcTime run_began{};
};

/// Called once per datagram; the bytes are valid during the call.
class DatagramSink {
 public:
  virtual ~DatagramSink() = default;
  virtual void datagram(std::span<std::byte> bytes, const sockaddr_in& sender) = 0;
};

/// Loses datagrams or hands them on late. The n-th one a process receives while there are faults
/// meets the same fate whenever the seed is the same.
class FaultyPath {
 public:
  explicit FaultyPath(const ReceptionFaults& reception) : reception_(reception) {}

  /// Takes one that arrived at a socket.
  void receive(int fd, std::span<const std::byte> bytes, const sockaddr_in& sender, UtcTime at);

  /// Hands on what has been kept long enough, in the order it is due.
  void hand_due(int fd, UtcTime now, DatagramSink& sink);

 private:
  /// More are lost, like in a router: a second of what the busiest process hears.
  static constexpr std::size_t kMostKept = 8192;
  /// What nobody fetches for so long was for a socket that is closed.
  static constexpr Duration kAbandoned = std::chrono::seconds(5);

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
