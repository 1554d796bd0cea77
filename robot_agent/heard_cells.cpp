// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/heard_cells.hpp"

#include <bit>

#include "swarmflow/core/random.hpp"

namespace swarm::agent {

std::size_t HeardCells::bucket_of(std::int64_t x, std::int64_t y) const {
  return mix_seed(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)) & mask_;
}

void HeardCells::sort(const std::vector<HeardState>& heard) {
  mask_ = std::bit_ceil(heard.size() + 1) - 1;
  begin_.assign(mask_ + 2, 0);
  bucket_.resize(heard.size());
  for (std::size_t i = 0; i < heard.size(); ++i) {
    const Vec2& at_m = heard[i].report.position_m;
    bucket_[i] = static_cast<std::uint32_t>(bucket_of(row_of(at_m.x()), row_of(at_m.y())));
    ++begin_[bucket_[i] + 1];
  }
  for (std::size_t b = 1; b < begin_.size(); ++b) begin_[b] += begin_[b - 1];
  // Filling a bucket moves its begin to its end, which is the begin of the next.
  sorted_.resize(heard.size());
  for (std::size_t i = 0; i < heard.size(); ++i) sorted_[begin_[bucket_[i]]++] = heard[i];
  for (std::size_t b = begin_.size() - 1; b > 0; --b) begin_[b] = begin_[b - 1];
  begin_[0] = 0;
}

}  // namespace swarm::agent
