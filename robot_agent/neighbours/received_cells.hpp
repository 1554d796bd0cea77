// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "robot_agent/neighbours/neighbour_table.hpp"

namespace swarm::agent {

/// A state that passed the input validation, with its age.
struct ReceivedState {
  NeighbourReport report;
  Duration age{};  ///< from its stamp to now, by the clocks of sender and receiver
};

/// The states that a process received at a tick, sorted so that each of its many robots visits only
/// those near it: into square cells, and the cells by a hash into buckets. No allocation once warm.
class ReceivedCells {
 public:
  /// \pre cell_m > 0
  explicit ReceivedCells(double cell_m) : cell_m_(cell_m) {}

  /// Replaces the content, in O(received states). Positions must be finite.
  void sort(const std::vector<ReceivedState>& received);

  /// Visits, once, all states within a cell's size of a position, and some farther ones.
  template <class Visit>
  void visit_near(const Vec2& position_m, Visit visit) const {
    const std::int64_t x = row_of(position_m.x()), y = row_of(position_m.y());
    std::array<std::size_t, 9> buckets;  // two cells may share one
    std::size_t count = 0;
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) buckets[count++] = bucket_of(x + dx, y + dy);
    }
    std::sort(buckets.begin(), buckets.end());
    const auto end = std::unique(buckets.begin(), buckets.end());
    for (auto bucket = buckets.begin(); bucket != end; ++bucket) {
      for (std::size_t i = begin_[*bucket]; i < begin_[*bucket + 1]; ++i) visit(sorted_[i]);
    }
  }

 private:
  std::int64_t row_of(double coordinate_m) const {
    return static_cast<std::int64_t>(std::floor(coordinate_m / cell_m_));
  }
  std::size_t bucket_of(std::int64_t x, std::int64_t y) const;

  double cell_m_;
  std::size_t mask_ = 0;
  std::vector<std::uint32_t> begin_ = {0, 0};  // of each bucket in sorted_; one more at the end
  std::vector<std::uint32_t> bucket_;          // of each state received
  std::vector<ReceivedState> sorted_;
};

}  // namespace swarm::agent
