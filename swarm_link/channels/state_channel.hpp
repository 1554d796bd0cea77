// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "swarm_link/port.hpp"
#include "swarmflow/core/linalg.hpp"

namespace swarm::link {

/// Publishes the states of the robots of a process and receives those of robots near them. Not
/// thread-safe: the tick of the process calls all functions.
class StateChannel {
 public:
  virtual ~StateChannel() = default;

  /// Publishes states, one batch per cell or several of at most kMaxCellStates; for a while also in
  /// the cell that a robot has left (see LeftCells). Returns the number of states sent.
  virtual std::size_t publish(std::span<const RobotStateMessage> states) = 0;

  /// While set, states go to all processes of the run beside those that receive the cell: new
  /// endpoints of cells may not be discovered. Nothing where cells need no discovery.
  virtual void publish_everywhere(bool /*is_on*/) {}

  /// Sets the positions of this process's robots, once per tick: joins the cells they need and
  /// leaves those they no longer need (with hysteresis).
  virtual void listen_around(std::span<const Vec2> positions_m) = 0;

  /// Whether the states of a robot at this position are received: its cell is among those that
  /// the last listen_around() needs.
  virtual bool receives_at(const Vec2& position_m) const = 0;

  /// Appends the cell batches received since the last call, including those that this process sent
  /// itself: robots of one process receive each other over the bus like all others.
  virtual std::size_t take(std::vector<CellStatesMessage>& out) = 0;

  /// Whether all cells that the positions of the last listen_around() need can be received, and the
  /// robots' own states be published. A process for which it is false would enter cells without
  /// receiving who is there. It is tried again at each listen_around().
  virtual bool receives_all() const { return true; }
  /// Whether that is for lack of open files, see `ulimit -n`.
  virtual bool lacks_files() const { return false; }

  /// Batches that could not be decoded, since the start.
  virtual std::uint64_t undecodable() const = 0;
};

/// The spatial grid of a channel and its hysteresis; see CellInterest.
struct CellOptions {
  double cell_size_m = 20.0;            ///< edge length of a cell
  double communication_radius_m = 4.0;  ///< states of robots this near must be received
  double join_margin_m = 1.5;           ///< a cell is joined this far outside the radius
  double leave_margin_m = 3.0;  ///< a cell is left this far outside; at least the join margin
};

/// The `topics` channel: one ordinary topic per cell, with endpoints that are created and
/// discovered as robots move. Writers are created when a robot is within `join_margin_m` of a cell,
/// so that they are discovered by the time it enters. Writers of cells that were left are kept, up
/// to a small number, because discovery is costly and keeping them is not. The topic for all
/// processes has its endpoints from the first listen_around() on. Call
/// participant.receive() before take(). An endpoint that the bus refuses is tried again at the next
/// call. Works with any participant. \pre participant outlives the channel
std::unique_ptr<StateChannel> make_topic_channel(Participant& participant,
                                                 const CellOptions& options);

}  // namespace swarm::link
