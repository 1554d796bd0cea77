// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"
#include "swarm_link/messages.hpp"

namespace swarm::link {

/// Hears every state that any robot of a domain says by the `groups` channel, the moment it is
/// said: for measuring. One socket, however many cells there are: the kernel hands it what is sent
/// to any group that somebody on this machine has joined, and robots join their own.
class GroupTap {
 public:
  virtual ~GroupTap() = default;

  /// Waits up to `timeout` for something to come and appends it. Returns how many batches came.
  virtual std::size_t take(Duration timeout, std::vector<CellStatesMessage>& out) = 0;

  /// The same for samples as they are, CDR with its encapsulation; they live as long as the call.
  using RawSink = std::function<void(std::span<const std::byte>)>;
  virtual std::size_t take_raw(Duration timeout, const RawSink& sink) = 0;

  virtual std::uint64_t undecodable() const = 0;
};

Result<std::unique_ptr<GroupTap>> make_group_tap(std::uint32_t domain);

}  // namespace swarm::link
