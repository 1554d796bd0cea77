// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "swarm_link/messages.hpp"

namespace swarm::link {

/// Remembers the last 64 states that a robot of this process published, by sequence number and
/// stamp. A received state under its id is either one of these, which the bus delivered back, or
/// forged.
class EchoGuard {
 public:
  /// Call it for every published state, before its echo can arrive.
  void record_sent(const RobotStateMessage& state) {
    published_[next_++ % published_.size()] = {state.sequence_number, state.stamp_utc_ns};
  }
  /// Whether a received state was published by us, by number and stamp. Searches all 64, at most
  /// once per received state.
  bool is_echo(const RobotStateMessage& state) const {
    for (const Published& p : published_) {
      if (p.sequence == state.sequence_number && p.stamp == state.stamp_utc_ns) return true;
    }
    return false;
  }

 private:
  struct Published {
    std::uint32_t sequence = 0;
    std::int64_t stamp = 0;
  };
  /// Ring buffer. A state that returns later than 64 states after it was sent counts as forged.
  std::array<Published, 64> published_{};
  std::size_t next_ = 0;
};

}  // namespace swarm::link
