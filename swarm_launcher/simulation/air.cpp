// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/simulation/air.hpp"

#include <cmath>
#include <utility>

namespace swarm::launcher {
namespace {

constexpr double kMaxCells = 1e6;

/// Cells as wide as the reach, or wider where the world is vast.
double cell_size_m(const Vec2& extent_m, double reach_m) {
  return std::max(reach_m, std::sqrt(extent_m.x() * extent_m.y() / kMaxCells));
}

}  // namespace

Air::Air(const Box& bounds_m, double reach_m, const LinkFaults& faults, std::uint64_t seed)
    : faults_(faults),
      seed_(seed),
      origin_m_(bounds_m.min_m),
      cell_m_(cell_size_m(bounds_m.max_m - bounds_m.min_m, reach_m)),
      columns_(1 + static_cast<int>((bounds_m.max_m.x() - bounds_m.min_m.x()) / cell_m_)),
      rows_(1 + static_cast<int>((bounds_m.max_m.y() - bounds_m.min_m.y()) / cell_m_)) {}

void Air::post(SteadyTime at, std::span<const agent::NeighbourReport> said) {
  if (said.empty()) return;
  Moment moment;
  if (!spare_.empty()) {
    moment = std::move(spare_.back());
    spare_.pop_back();
  }
  moment.at = at;
  moment.begin.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
  moment.said.resize(said.size());
  cells_.resize(said.size());
  for (std::size_t i = 0; i < said.size(); ++i) {
    cells_[i] = static_cast<std::uint32_t>(row_of(said[i].position_m.y()) * columns_ +
                                           column_of(said[i].position_m.x()));
    ++moment.begin[cells_[i] + 1];
  }
  for (std::size_t c = 1; c < moment.begin.size(); ++c) moment.begin[c] += moment.begin[c - 1];
  // Filling a cell moves its begin to its end, which is the begin of the next.
  for (std::size_t i = 0; i < said.size(); ++i) moment.said[moment.begin[cells_[i]]++] = said[i];
  for (std::size_t c = moment.begin.size() - 1; c > 0; --c) moment.begin[c] = moment.begin[c - 1];
  moment.begin[0] = 0;
  moments_.push_back(std::move(moment));
}

void Air::forget(SteadyTime time) {
  while (!moments_.empty() && moments_.front().at + faults_.delay + faults_.jitter < time) {
    spare_.push_back(std::move(moments_.front()));
    moments_.pop_front();
  }
}

bool Air::arrives(const agent::NeighbourReport& report, RobotId receiver, SteadyTime due,
                  SteadyTime from, SteadyTime until) const {
  const std::uint64_t message =
      static_cast<std::uint64_t>(report.robot.value()) << 32U | report.sequence;
  const std::uint64_t fate = mix_seed(mix_seed(seed_, message), receiver.value());
  constexpr double kScale = 0x1.0p-32;
  if (static_cast<double>(fate & 0xFFFFFFFFU) * kScale < faults_.loss) return false;
  const double turn = 2.0 * (static_cast<double>(fate >> 32U) * kScale) - 1.0;
  const SteadyTime arrival =
      due + Duration(std::llround(turn * static_cast<double>(faults_.jitter.count())));
  return arrival >= from && arrival < until;
}

}  // namespace swarm::launcher
