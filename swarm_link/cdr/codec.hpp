// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "swarm_link/messages.hpp"

namespace swarm::link {

/// A message as the bytes that travel on its topic: plain CDR with its encapsulation, by the code
/// generated from the IDL. For those who speak without a vendor: the groups channel and recordings.
/// Keeps its memory. Not thread-safe.
template <class M>
class Codec {
 public:
  Codec();
  ~Codec();

  /// Replaces `out`; false when the message is beyond the contract.
  bool encode(const M& message, std::vector<std::byte>& out);

  /// False when the bytes are not a sample; `out` is unspecified then. Does not change the bytes.
  bool decode(std::span<std::byte> bytes, M& out);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

extern template class Codec<PlanMessage>;
extern template class Codec<SceneMessage>;
extern template class Codec<HeartbeatMessage>;
extern template class Codec<CellStatesMessage>;
extern template class Codec<CommandMessage>;
extern template class Codec<StatusMessage>;
extern template class Codec<EventMessage>;

}  // namespace swarm::link
