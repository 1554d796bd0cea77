// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/neighbours/received_cells.hpp"

#include <bit>

#include "swarmflow/core/random.hpp"

namespace swarm::agent {

/// Different cells may share a bucket: that costs visits of states which are not near, no errors.
std::size_t ReceivedCells::bucket_of(std::int64_t x, std::int64_t y) const {
  return mix_seed(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)) & mask_;
}

/// Counting sort by bucket: counts, prefix sums, then one pass that places the states. There are as
/// many buckets as states, rounded up to a power of two, so a bucket holds about one.
void ReceivedCells::sort(const std::vector<ReceivedState>& received) {
  mask_ = std::bit_ceil(received.size() + 1) - 1;
  begin_.assign(mask_ + 2, 0);
  bucket_.resize(received.size());
  for (std::size_t i = 0; i < received.size(); ++i) {
    const Vec2& at_m = received[i].report.position_m;
    bucket_[i] = static_cast<std::uint32_t>(bucket_of(row_of(at_m.x()), row_of(at_m.y())));
    ++begin_[bucket_[i] + 1];
  }
  for (std::size_t b = 1; b < begin_.size(); ++b) begin_[b] += begin_[b - 1];
  // Filling a bucket moves its begin to its end, which is the begin of the next.
  sorted_.resize(received.size());
  for (std::size_t i = 0; i < received.size(); ++i) sorted_[begin_[bucket_[i]]++] = received[i];
  for (std::size_t b = begin_.size() - 1; b > 0; --b) begin_[b] = begin_[b - 1];
  begin_[0] = 0;
}

}  // namespace swarm::agent
