// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "swarm_link/messages.hpp"

namespace swarm::link {

/// Cell states as the bytes that travel on their topic: plain CDR with its encapsulation, by the
/// code generated from the IDL. Keeps its memory. Not thread-safe.
class CellStatesCdr {
 public:
  CellStatesCdr();
  ~CellStatesCdr();

  /// Replaces `out`; false when the message is beyond the contract.
  bool encode(const CellStatesMessage& message, std::vector<std::byte>& out);

  /// False when the bytes are not a sample; `out` is unspecified then.
  bool decode(std::span<std::byte> bytes, CellStatesMessage& out);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace swarm::link
