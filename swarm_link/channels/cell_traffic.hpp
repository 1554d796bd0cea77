// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
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

  /// Whether the last update() wanted the cell of this position. O(log cells).
  bool covers(const Vec2& position_m) const;

 private:
  CellOptions options_;
  std::vector<Cell> wanted_;              ///< sorted
  std::vector<Cell> join_, keep_, kept_;  ///< of the last update(), whose memory the next one uses
};

/// The cells that robots have left lately. Who receives the old cell but not the new one would take
/// the robot's silence for that of a robot that has stopped somewhere: so its next states go to
/// both cells. Several of them, because one may be lost. Allocates for each new robot.
class LeftCells {
 public:
  /// States that go to the old cell as well.
  static constexpr std::uint32_t kTimes = 4;

  /// Call it for each state that is published, with its cell: the other cell that it goes to.
  std::optional<Cell> update(std::uint32_t robot, const Cell& cell);

 private:
  struct Track {
    Cell cell;
    Cell left;
    std::uint32_t times = 0;  // that are still due
  };
  std::unordered_map<std::uint32_t, Track> tracks_;
};

/// Robot states sorted into one batch per cell, or several of at most kMaxCellStates.
class CellBatches {
 public:
  explicit CellBatches(double cell_size_m) : cell_size_m_(cell_size_m) {}

  /// Sorts the states by cell. The result is valid until the next call; memory is reused. With
  /// `left`, a state is also in the batch of the cell that its robot has left.
  std::span<const CellStatesMessage> sort(std::span<const RobotStateMessage> states,
                                          LeftCells* left = nullptr);

 private:
  double cell_size_m_;
  std::vector<std::pair<Cell, std::size_t>> order_;  ///< cell and index of each state
  std::vector<CellStatesMessage> batches_;           ///< more than the last call needed, reused
};

/// Sorted union of the cells that discs around the points touch, in place of what `cells` has.
void cells_around(std::span<const Vec2> centers_m, double radius_m, double cell_size_m,
                  std::vector<Cell>& cells);

}  // namespace swarm::link
