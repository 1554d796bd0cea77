// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "swarmflow/core/linalg.hpp"
#include "swarm_link/port.hpp"

namespace swarm::link {

/// How robots of a process tell others their states and hear those of others near them.
class StateChannel {
 public:
  virtual ~StateChannel() = default;

  /// Says states, sorted into their cells and batched per cell. Returns how many were sent.
  virtual std::size_t publish(std::span<const RobotStateMessage> states) = 0;

  /// Declares where this process's robots are, once a tick: joins the cells they need, leaves the
  /// ones they no longer do (with hysteresis).
  virtual void listen_around(std::span<const Vec2> positions_m) = 0;

  /// Appends the cell batches heard since the last call; what this process says itself comes back
  /// as well (robots of one process hear each other over the bus like all others).
  virtual std::size_t take(std::vector<CellStatesMessage>& out) = 0;

  /// Batches that did not decode, since the start.
  virtual std::uint64_t undecodable() const = 0;
};

struct CellOptions {
  double cell_size_m = 20.0;
  double communication_radius_m = 4.0;
  double join_margin_m = 1.5;
  double leave_margin_m = 3.0;
};

/// The `topics` channel: one ordinary topic per cell, endpoints made and discovered as robots move.
/// Writers are made `join_margin_m` before a robot enters a cell, so that they are discovered when
/// it does, and those of left cells linger (their discovery is dear, keeping them is not) up to a
/// small number. Call participant.receive() before take(). An endpoint the bus refuses is tried
/// again. Works over any participant. \pre participant outlives the channel
std::unique_ptr<StateChannel> make_topic_channel(Participant& participant,
                                                 const CellOptions& options);

}  // namespace swarm::link
