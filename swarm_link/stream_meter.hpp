// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "swarm_core/metrics/histogram.hpp"
#include "swarm_link/messages.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::link {

/// Measures the state streams of all robots at one receiver: whether every state arrived, once, in
/// order, and how late. Robots number their states consecutively; a number far below the highest
/// means that the robot was restarted. Memory is fixed by the number of robots.
class StreamMeter {
 public:
  explicit StreamMeter(std::uint32_t robots) : streams_(robots) {}

  /// Counts a state that arrived at time `at`.
  void receive(const RobotStateMessage& state, UtcTime at);

  /// Totals over all robots since the start.
  struct Counts {
    std::uint64_t received = 0;    ///< states, each once
    std::uint64_t lost = 0;        ///< numbers skipped that did not arrive later
    std::uint64_t gaps = 0;        ///< times that one or more numbers were skipped
    std::uint64_t duplicates = 0;  ///< states that arrived again
    std::uint64_t reordered = 0;   ///< states that arrived after a higher number
    std::uint64_t strange = 0;     ///< states with ids outside the mission
    std::uint64_t sent() const { return received + lost; }
  };
  const Counts& counts() const { return counts_; }

  /// From the stamp of a state to its arrival here [µs].
  const Histogram& latency() const { return latency_; }
  /// The same since the last call.
  Histogram take_recent_latency();

  /// The state with the largest latency so far.
  struct Worst {
    RobotId robot;
    std::int64_t latency_us = 0;
  };
  Worst worst() const { return worst_; }

 private:
  /// A number this far below the highest is a restart, not a reordered state.
  static constexpr std::uint32_t kWindow = 64;

  /// Per robot: the highest number and which of the 64 numbers up to it arrived.
  struct Stream {
    std::uint32_t first = 0;     // with which it began; earlier ones are not missing
    std::uint32_t highest = 0;   // 0: never received
    std::uint64_t received = 0;  // bit k: highest − k
  };

  std::vector<Stream> streams_;  ///< by robot
  Counts counts_;
  Histogram latency_;
  Histogram recent_;  ///< since take_recent_latency()
  Worst worst_;
};

}  // namespace swarm::link
