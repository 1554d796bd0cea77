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

/// The bus of a simulation: carries robot states from those who say them to those near enough, late
/// or never as the faults have it. What becomes of a message is a function of the seed, its sender,
/// number and receiver, whoever asks and when: any number of threads may hear at a time.
class SimulatedNetwork {
 public:
  /// `largest_communication_radius_m` is the largest communication radius of any robot, `begin` the run's.
  SimulatedNetwork(const Box& bounds_m, double largest_communication_radius_m, const LinkFaults& faults, std::uint64_t seed,
      SteadyTime begin);

  /// Puts what robots said at a moment on the air; moments ascend.
  void post(SteadyTime at, std::span<const agent::NeighbourReport> sent);

  /// Nobody asks for what was due before `time` any more.
  void forget(SteadyTime time);

  /// Hands over what reaches a robot at `position_m` with communication radius `communication_radius_m` in
  /// [from, until), its own words left out. Costs what was published in up to nine cells.
  template <class Take>
  void receive(RobotId receiver, const Vec2& position_m, double communication_radius_m, SteadyTime from,
            SteadyTime until, Take take) const {
    const int x0 = column_of(position_m.x() - communication_radius_m), x1 = column_of(position_m.x() + communication_radius_m);
    const int y0 = row_of(position_m.y() - communication_radius_m), y1 = row_of(position_m.y() + communication_radius_m);
    const double range_squared = communication_radius_m * communication_radius_m;
    for (const Moment& moment : moments_) {
      const bool faulty = faults_.any() && faults_.at(moment.at - begin_);
      const Duration delay = faulty ? faults_.delay : Duration::zero();
      const Duration jitter = faulty ? faults_.jitter : Duration::zero();
      if (moment.at + delay + jitter < from || moment.at + delay - jitter >= until) continue;
      for (int y = y0; y <= y1; ++y) {
        const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_);
        const std::size_t first = moment.begin[row + static_cast<std::size_t>(x0)];
        const std::size_t last = moment.begin[row + static_cast<std::size_t>(x1) + 1];
        for (std::size_t i = first; i < last; i += kAtOnce) {
          // Who is in range is unpredictable: found without a branch.
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
  static constexpr std::size_t kAtOnce = 64;

  struct Moment {
    SteadyTime at;
    std::vector<std::uint32_t> begin;  // of each cell in `sent`, row by row; one more at the end
    std::vector<agent::NeighbourReport> sent;
  };

  int column_of(double x_m) const {
    return std::clamp(static_cast<int>((x_m - origin_m_.x()) / cell_m_), 0, columns_ - 1);
  }
  int row_of(double y_m) const {
    return std::clamp(static_cast<int>((y_m - origin_m_.y()) / cell_m_), 0, rows_ - 1);
  }
  bool arrives(const agent::NeighbourReport& report, RobotId receiver, SteadyTime sent_at,
               SteadyTime from, SteadyTime until) const;

  LinkFaults faults_;
  SteadyTime begin_;
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
