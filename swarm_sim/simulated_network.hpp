// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "robot_agent/neighbours/neighbour_table.hpp"
#include "swarm_core/mission/link_faults.hpp"
#include "swarmflow/core/box.hpp"

namespace swarm::launcher {

/// The bus of a simulation: carries robot states from their senders to the robots within the
/// communication radius, delayed or lost as the faults demand. What happens to a message is a
/// function of the seed, its sender, number and receiver alone: any number of threads may receive
/// at a time, in any order.
class SimulatedNetwork {
 public:
  /// `largest_communication_radius_m` is that of all robots, `begin` the time that faults count
  /// from.
  SimulatedNetwork(const Box& bounds_m, double largest_communication_radius_m,
                   const LinkFaults& faults, std::uint64_t seed, SteadyTime begin);

  /// Sends the states that robots published at a moment; moments ascend.
  void post(SteadyTime at, std::span<const agent::NeighbourReport> sent);

  /// Drops states due before `time`: no robot will receive them any more.
  void forget(SteadyTime time);

  /// Hands over what reaches a robot at `position_m` with communication radius
  /// `communication_radius_m` in [from, until), except its own states. O(states published in up to
  /// nine cells).
  template <class Take>
  void receive(RobotId receiver, const Vec2& position_m, double communication_radius_m,
               SteadyTime from, SteadyTime until, Take take) const {
    const int x0 = column_of(position_m.x() - communication_radius_m),
              x1 = column_of(position_m.x() + communication_radius_m);
    const int y0 = row_of(position_m.y() - communication_radius_m),
              y1 = row_of(position_m.y() + communication_radius_m);
    const double range_squared = communication_radius_m * communication_radius_m;
    for (const Moment& moment : moments_) {
      const bool faulty = faults_.any() && faults_.at(moment.at - begin_);
      const Duration delay = faulty ? faults_.delay : Duration::zero();
      const Duration jitter = faulty ? faults_.jitter : Duration::zero();
      if (moment.at + delay + jitter < from || moment.at + delay - jitter >= until) continue;
      const bool few = moment.sent.size() <= kFew;  // all are tested, as if they were in one row
      for (int y = few ? y1 : y0; y <= y1; ++y) {
        const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_);
        const std::size_t first = few ? 0 : moment.begin[row + static_cast<std::size_t>(x0)];
        const std::size_t last =
            few ? moment.sent.size() : moment.begin[row + static_cast<std::size_t>(x1) + 1];
        for (std::size_t i = first; i < last; i += kAtOnce) {
          // Which senders are in range is unpredictable: they are found without a branch.
          std::array<std::uint32_t, kAtOnce> near;
          std::size_t found = 0;
          for (std::size_t k = i; k < std::min(last, i + kAtOnce); ++k) {
            near[found] = static_cast<std::uint32_t>(k);
            found += (moment.sent[k].position_m - position_m).squaredNorm() <= range_squared;
          }
          for (std::size_t k = 0; k < found; ++k) {
            const agent::NeighbourReport& report = moment.sent[near[k]];
            if (report.robot == receiver) continue;
            if (!faulty || arrives(report, receiver, moment.at, from, until)) take(report);
          }
        }
      }
    }
  }

 private:
  /// Senders tested before those in range are handed over: a small list that stays in the cache.
  static constexpr std::size_t kAtOnce = 64;
  /// So few states are tested one by one faster than their cells are looked up.
  static constexpr std::size_t kFew = 16;

  /// The states sent at one moment, sorted by cell.
  struct Moment {
    SteadyTime at;
    std::vector<std::uint32_t> begin;  // of each cell in `sent`, row by row; two more at the end
    std::vector<agent::NeighbourReport> sent;
  };

  /// Positions outside of the bounds belong to the cells at the border.
  int column_of(double x_m) const {
    return std::clamp(static_cast<int>((x_m - origin_m_.x()) / cell_m_), 0, columns_ - 1);
  }
  int row_of(double y_m) const {
    return std::clamp(static_cast<int>((y_m - origin_m_.y()) / cell_m_), 0, rows_ - 1);
  }
  /// Whether a message reaches the receiver, and does so in [from, until).
  bool arrives(const agent::NeighbourReport& report, RobotId receiver, SteadyTime sent_at,
               SteadyTime from, SteadyTime until) const;

  // Loss, delay and jitter, in force in an interval from begin_ on.
  LinkFaults faults_;
  SteadyTime begin_;
  std::uint64_t seed_;
  // The grid of cells: its lower left corner, the size of a cell, and their numbers.
  Vec2 origin_m_;
  double cell_m_;
  int columns_;
  int rows_;
  std::deque<Moment> moments_;
  std::vector<Moment> spare_;  // forgotten moments, kept for their memory
  std::vector<std::uint32_t> cells_;
};

}  // namespace swarm::launcher
