// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/time.hpp"
#include "swarm_core/metrics/histogram.hpp"
#include "swarm_link/messages.hpp"

namespace swarm::link {

/// What a listener hears of all robots: whether every state came, once, in order, and how late.
/// Robots number their states without holes; one that begins anew far below its last number was
/// restarted. Memory is fixed by the number of robots.
class StreamMeter {
 public:
  explicit StreamMeter(std::uint32_t robots) : streams_(robots) {}

  void receive(const RobotStateMessage& state, UtcTime at);

  struct Counts {
    std::uint64_t received = 0;    ///< states, each once
    std::uint64_t lost = 0;        ///< numbers skipped and not made up for since
    std::uint64_t gaps = 0;        ///< times that numbers were skipped
    std::uint64_t duplicates = 0;  ///< states that came again
    std::uint64_t reordered = 0;   ///< states that came after one with a higher number
    std::uint64_t strange = 0;     ///< states of robots that do not exist
    std::uint64_t sent() const { return received + lost; }
  };
  const Counts& counts() const { return counts_; }

  /// From the stamp of a state to its arrival here [µs].
  const Histogram& latency() const { return latency_; }
  /// The same since the last call.
  Histogram take_recent_latency();

  struct Worst {
    RobotId robot;
    std::int64_t latency_us = 0;
  };
  Worst worst() const { return worst_; }

 private:
  static constexpr std::uint32_t kWindow = 64;

  struct Stream {
    std::uint32_t highest = 0;   // 0: never received
    std::uint64_t received = 0;  // bit k: highest − k
  };

  std::vector<Stream> streams_;
  Counts counts_;
  Histogram latency_;
  Histogram recent_;
  Worst worst_;
};

}  // namespace swarm::link
