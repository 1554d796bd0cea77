// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "swarm_link/channels/cell.hpp"
#include "swarm_link/messages.hpp"
#include "swarm_link/channels/state_channel.hpp"

/// What every state channel does with cells, whatever carries them. Pure.
namespace swarm::link {

/// The cells a process must hear, with hysteresis: a robot that sways on a border does not make
/// its process join and leave at every tick.
class CellInterest {
 public:
  explicit CellInterest(const CellOptions& options);

  /// While robots stand at these places: every cell within hear radius + join margin of one, and
  /// those wanted before within hear radius + leave margin. Sorted; valid until the next call.
  std::span<const Cell> update(std::span<const Vec2> positions_m);

 private:
  CellOptions options_;
  std::vector<Cell> wanted_;
};

/// Robot states sorted into one batch per cell, or several of at most kMaxCellStates.
class CellBatches {
 public:
  explicit CellBatches(double cell_size_m) : cell_size_m_(cell_size_m) {}

  /// Valid until the next call; keeps its memory.
  std::span<const CellStatesMessage> sort(std::span<const RobotStateMessage> states);

 private:
  double cell_size_m_;
  std::vector<std::pair<Cell, std::size_t>> order_;
  std::vector<CellStatesMessage> batches_;
};

/// Sorted union of the cells that discs around the points touch.
std::vector<Cell> cells_around(std::span<const Vec2> centers_m, double radius_m,
                               double cell_size_m);

}  // namespace swarm::link
