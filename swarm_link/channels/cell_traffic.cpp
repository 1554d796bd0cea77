// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/channels/cell_traffic.hpp"

#include <algorithm>
#include <iterator>

#include "swarm_core/base/assert.hpp"

namespace swarm::link {

CellInterest::CellInterest(const CellOptions& options) : options_(options) {
  SWARM_ASSERT(options.cell_size_m > 0.0 && options.communication_radius_m >= 0.0);
  SWARM_ASSERT(0.0 <= options.join_margin_m && options.join_margin_m <= options.leave_margin_m);
}

// wanted = join ∪ (wanted before ∩ keep). All three sets are sorted, so each step is linear.
std::span<const Cell> CellInterest::update(std::span<const Vec2> positions_m) {
  const double size = options_.cell_size_m;
  const double radius_m = options_.communication_radius_m;
  cells_around(positions_m, radius_m + options_.join_margin_m, size, join_);
  cells_around(positions_m, radius_m + options_.leave_margin_m, size, keep_);
  kept_.clear();
  std::ranges::set_intersection(wanted_, keep_, std::back_inserter(kept_));
  wanted_.clear();
  std::ranges::set_union(kept_, join_, std::back_inserter(wanted_));
  return wanted_;
}

bool CellInterest::covers(const Vec2& position_m) const {
  return std::ranges::binary_search(wanted_, cell_of(position_m, options_.cell_size_m));
}

// A robot that returns to the cell it has left needs no second copy.
std::optional<Cell> LeftCells::update(std::uint32_t robot, const Cell& cell) {
  const auto [found, is_new] = tracks_.try_emplace(robot, Track{.cell = cell, .left = cell});
  Track& track = found->second;
  if (track.cell != cell) track = {.cell = cell, .left = track.cell, .times = kTimes};
  if (track.times == 0) return std::nullopt;
  --track.times;
  return track.left;
}

// Sorts indices by cell, then splits the sequence at every new cell and at full batches. Batches of
// earlier calls are reused, with the memory of their states.
std::span<const CellStatesMessage> CellBatches::sort(std::span<const RobotStateMessage> states,
                                                     LeftCells* left) {
  order_.clear();
  for (std::size_t i = 0; i < states.size(); ++i) {
    const Cell cell = cell_of({states[i].x_m, states[i].y_m}, cell_size_m_);
    order_.emplace_back(cell, i);
    if (left == nullptr) continue;
    if (const auto other = left->update(states[i].robot_id, cell)) order_.emplace_back(*other, i);
  }
  std::sort(order_.begin(), order_.end());
  std::size_t used = 0;
  CellStatesMessage* batch = nullptr;
  for (const auto& [cell, i] : order_) {
    if (batch == nullptr || Cell{batch->cell_x, batch->cell_y} != cell ||
        batch->states.size() == kMaxCellStates) {
      if (used == batches_.size()) batches_.emplace_back();
      batch = &batches_[used++];
      batch->cell_x = cell.x;
      batch->cell_y = cell.y;
      batch->states.clear();
    }
    batch->states.push_back(states[i]);
  }
  return std::span(batches_).first(used);
}

// Collects with repetitions, then sorts: cheaper than a set for the few cells of a process.
void cells_around(std::span<const Vec2> centers_m, double radius_m, double cell_size_m,
                  std::vector<Cell>& cells) {
  cells.clear();
  for (const Vec2& center : centers_m) add_cells_touching(center, radius_m, cell_size_m, cells);
  if (centers_m.size() == 1) return;  // sorted already
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

}  // namespace swarm::link
