// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_sim/simulated_network.hpp"

#include <cmath>
#include <utility>

#include "swarmflow/core/random.hpp"

namespace swarm::launcher {
namespace {

constexpr double kMaxCells = 1e6;

/// Cells as wide as the largest communication radius, so that nine of them hold all that a robot
/// receives; wider where that would make more than a million cells.
double cell_size_m(const Vec2& extent_m, double largest_communication_radius_m) {
  return std::max(largest_communication_radius_m,
                  std::sqrt(extent_m.x() * extent_m.y() / kMaxCells));
}

}  // namespace

SimulatedNetwork::SimulatedNetwork(const Box& bounds_m, double largest_communication_radius_m,
                                   const LinkFaults& faults, std::uint64_t seed, SteadyTime begin)
    : faults_(faults),
      begin_(begin),
      seed_(seed),
      origin_m_(bounds_m.min_m),
      cell_m_(cell_size_m(bounds_m.max_m - bounds_m.min_m, largest_communication_radius_m)),
      columns_(1 + static_cast<int>((bounds_m.max_m.x() - bounds_m.min_m.x()) / cell_m_)),
      rows_(1 + static_cast<int>((bounds_m.max_m.y() - bounds_m.min_m.y()) / cell_m_)) {}

/// Counting sort of the states by cell, row by row, in O(states + cells). Uses the memory of a
/// forgotten moment.
[[gnu::hot]] void SimulatedNetwork::post(SteadyTime at,
                                         std::span<const agent::NeighbourReport> sent) {
  if (sent.empty()) return;
  Moment moment;
  if (!spare_.empty()) {
    moment = std::move(spare_.back());
    spare_.pop_back();
  }
  moment.at = at;
  // Counts of cell c at c + 2: filling the cells moves their begins down to where they belong.
  moment.begin.assign(static_cast<std::size_t>(columns_ * rows_) + 2, 0);
  moment.sent.resize(sent.size());
  cells_.resize(sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    cells_[i] = static_cast<std::uint32_t>(row_of(sent[i].position_m.y()) * columns_ +
                                           column_of(sent[i].position_m.x()));
    ++moment.begin[cells_[i] + 2];
  }
  for (std::size_t c = 2; c < moment.begin.size(); ++c) moment.begin[c] += moment.begin[c - 1];
  // Entry c + 1 is the begin of cell c, and after its states its end: the begin of cell c + 1.
  for (std::size_t i = 0; i < sent.size(); ++i)
    moment.sent[moment.begin[cells_[i] + 1]++] = sent[i];
  moments_.push_back(std::move(moment));
}

/// A state is due at the latest delay + jitter after it was sent.
void SimulatedNetwork::forget(SteadyTime time) {
  while (!moments_.empty() && moments_.front().at + faults_.delay + faults_.jitter < time) {
    spare_.push_back(std::move(moments_.front()));
    moments_.pop_front();
  }
}

/// The fate of a message (lost, or its delay) is drawn from a hash of seed, sender, number and
/// receiver, not from a generator with a state: threads and order do not matter.
bool SimulatedNetwork::arrives(const agent::NeighbourReport& report, RobotId receiver,
                               SteadyTime sent_at, SteadyTime from, SteadyTime until) const {
  const std::uint64_t message =
      static_cast<std::uint64_t>(report.robot.value()) << 32U | report.sequence;
  const auto delay = fate(faults_, mix_seed(seed_, message), receiver.value());
  return delay && sent_at + *delay >= from && sent_at + *delay < until;
}

}  // namespace swarm::launcher
