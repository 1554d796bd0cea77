// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "robot_agent/neighbour_table.hpp"
#include "swarm_core/base/random.hpp"
#include "swarm_core/world/box.hpp"

namespace swarm::launcher {

/// What the network does to robot states, for each pair of sender and receiver independently.
struct LinkFaults {
  double loss = 0.0;  ///< share that never arrives
  Duration delay{};
  Duration jitter{};  ///< each message comes up to this much earlier or later than `delay`

  bool any() const { return loss > 0.0 || delay > Duration::zero() || jitter > Duration::zero(); }
};

/// The bus of a simulation: carries robot states from those who say them to those near enough, late
/// or never as the faults have it. What becomes of a message is a function of the seed, its sender,
/// number and receiver, whoever asks and when: any number of threads may hear at a time.
class Air {
 public:
  /// `reach_m` is the largest sensing range of any robot.
  Air(const Box& bounds_m, double reach_m, const LinkFaults& faults, std::uint64_t seed);

  /// Puts what robots said at a moment on the air; moments ascend.
  void post(SteadyTime at, std::span<const agent::NeighbourReport> said);

  /// Nobody asks for what was due before `time` any more.
  void forget(SteadyTime time);

  /// Hands over what reaches a robot at `position_m` with sensing range `range_m` in
  /// [from, until), its own words left out. Costs what was said in up to nine cells.
  template <class Take>
  void hear(RobotId receiver, const Vec2& position_m, double range_m, SteadyTime from,
            SteadyTime until, Take take) const {
    const int x0 = column_of(position_m.x() - range_m), x1 = column_of(position_m.x() + range_m);
    const int y0 = row_of(position_m.y() - range_m), y1 = row_of(position_m.y() + range_m);
    const double range_squared = range_m * range_m;
    for (const Moment& moment : moments_) {
      const SteadyTime due = moment.at + faults_.delay;
      if (due + faults_.jitter < from || due - faults_.jitter >= until) continue;
      for (int y = y0; y <= y1; ++y) {
        const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_);
        const std::size_t first = moment.begin[row + static_cast<std::size_t>(x0)];
        const std::size_t last = moment.begin[row + static_cast<std::size_t>(x1) + 1];
        for (std::size_t i = first; i < last; i += kAtOnce) {
          // Who is in range is a coin toss: found without a branch.
          std::array<std::uint32_t, kAtOnce> near;
          std::size_t found = 0;
          for (std::size_t k = i; k < std::min(last, i + kAtOnce); ++k) {
            near[found] = static_cast<std::uint32_t>(k);
            found += (moment.said[k].position_m - position_m).squaredNorm() <= range_squared;
          }
          for (std::size_t k = 0; k < found; ++k) {
            const agent::NeighbourReport& report = moment.said[near[k]];
            if (report.robot == receiver) continue;
            if (!faults_.any() || arrives(report, receiver, due, from, until)) take(report);
          }
        }
      }
    }
  }

 private:
  static constexpr std::size_t kAtOnce = 64;

  struct Moment {
    SteadyTime at;
    std::vector<std::uint32_t> begin;  // of each cell in `said`, row by row; one more at the end
    std::vector<agent::NeighbourReport> said;
  };

  int column_of(double x_m) const {
    return std::clamp(static_cast<int>((x_m - origin_m_.x()) / cell_m_), 0, columns_ - 1);
  }
  int row_of(double y_m) const {
    return std::clamp(static_cast<int>((y_m - origin_m_.y()) / cell_m_), 0, rows_ - 1);
  }
  bool arrives(const agent::NeighbourReport& report, RobotId receiver, SteadyTime due,
               SteadyTime from, SteadyTime until) const;

  LinkFaults faults_;
  std::uint64_t seed_;
  Vec2 origin_m_;
  double cell_m_;
  int columns_;
  int rows_;
  std::deque<Moment> moments_;
  std::vector<Moment> spare_;  // keep their memory
  std::vector<std::uint32_t> cells_;
};

}  // namespace swarm::launcher
