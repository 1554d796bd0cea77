// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "swarm_link/channels/cell.hpp"
#include "swarm_link/channels/state_channel.hpp"
#include "swarm_link/messages.hpp"

/// Cell bookkeeping common to all state channels, independent of what transports the states. Pure.
namespace swarm::link {

/// The cells a process must receive, with hysteresis: a robot that moves to and fro across a border
/// does not make its process join and leave at every tick.
class CellInterest {
 public:
  explicit CellInterest(const CellOptions& options);

  /// Cells for robots at these positions: every cell within communication radius + join margin of a
  /// position, and those wanted before within communication radius + leave margin. Sorted; valid
  /// until the next call.
  std::span<const Cell> update(std::span<const Vec2> positions_m);

 private:
  CellOptions options_;
  std::vector<Cell> wanted_;  ///< sorted
};

/// Robot states sorted into one batch per cell, or several of at most kMaxCellStates.
class CellBatches {
 public:
  explicit CellBatches(double cell_size_m) : cell_size_m_(cell_size_m) {}

  /// Sorts the states by cell. The result is valid until the next call; memory is reused.
  std::span<const CellStatesMessage> sort(std::span<const RobotStateMessage> states);

 private:
  double cell_size_m_;
  std::vector<std::pair<Cell, std::size_t>> order_;  ///< cell and index of each state
  std::vector<CellStatesMessage> batches_;           ///< more than the last call needed, reused
};

/// Sorted union of the cells that discs around the points touch.
std::vector<Cell> cells_around(std::span<const Vec2> centers_m, double radius_m,
                               double cell_size_m);

}  // namespace swarm::link
