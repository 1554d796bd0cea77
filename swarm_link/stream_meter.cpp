// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/stream_meter.hpp"

#include <utility>

#include "swarm_core/base/stamp.hpp"

namespace swarm::link {

// Bit k of `received` stands for the number highest − k. A new highest number shifts the window and
// counts the skipped numbers as lost; a number that arrives late reduces that count by one.
// Duplicates do not enter the latency.
void StreamMeter::receive(const RobotStateMessage& state, UtcTime at) {
  if (state.robot_id >= streams_.size()) {
    ++counts_.strange;
    return;
  }
  Stream& stream = streams_[state.robot_id];
  const std::uint32_t number = state.sequence_number;
  if (stream.highest == 0 || (number < stream.highest && stream.highest - number >= kWindow)) {
    stream = {.first = number, .highest = number, .received = 1};
  } else if (number > stream.highest) {
    const std::uint32_t skipped = number - stream.highest - 1;
    stream.received = skipped + 1 < kWindow ? stream.received << (skipped + 1) | 1U : 1U;
    stream.highest = number;
    counts_.lost += skipped;
    counts_.gaps += skipped > 0 ? 1 : 0;
  } else {
    const std::uint64_t bit = std::uint64_t{1} << (stream.highest - number);
    if ((stream.received & bit) != 0) {
      ++counts_.duplicates;
      return;
    }
    stream.received |= bit;
    ++counts_.reordered;
    if (number > stream.first) --counts_.lost;  // one before the first was never counted as lost
  }
  ++counts_.received;
  if (!is_stamp(state.stamp_utc_ns)) return;  // no age to measure
  const std::int64_t age_us = (at.time_since_epoch().count() - state.stamp_utc_ns) / 1000;
  latency_.add(age_us);
  recent_.add(age_us);
  if (age_us > worst_.latency_us) worst_ = {RobotId(state.robot_id), age_us};
}

Histogram StreamMeter::take_recent_latency() { return std::exchange(recent_, Histogram{}); }

}  // namespace swarm::link
