// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "swarm_link/messages.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::link {

/// Receives every state that any robot of a domain publishes on the `groups` channel, for
/// measuring. It uses one socket for all cells: the kernel delivers to it what is sent to any group
/// that a process on this machine has joined, and robots join the groups around them. Not
/// thread-safe.
class GroupTap {
 public:
  virtual ~GroupTap() = default;

  /// Waits up to `timeout` for datagrams and appends their batches. Returns the number of batches.
  virtual std::size_t take(Duration timeout, std::vector<CellStatesMessage>& out) = 0;

  /// The same for encoded samples, CDR with its encapsulation. The bytes are valid during the call.
  using RawSink = std::function<void(std::span<const std::byte>)>;
  virtual std::size_t take_raw(Duration timeout, const RawSink& sink) = 0;

  /// Datagrams that are not samples of the groups, since the start.
  virtual std::uint64_t undecodable() const = 0;
};

/// Fails when the UDP port of the domain is not available.
Result<std::unique_ptr<GroupTap>> make_group_tap(std::uint32_t domain);

}  // namespace swarm::link
