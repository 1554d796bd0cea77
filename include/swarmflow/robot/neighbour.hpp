// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/linalg.hpp"

namespace swarm::agent {

/// The estimate that a robot has of a neighbour at its present tick.
struct Neighbour {
  RobotId robot;
  Vec2 position_m = Vec2::Zero();  ///< extrapolated from its last state
  Vec2 velocity_mps = Vec2::Zero();
  double radius_m = 0.0;  ///< its radius, grown while no state is received for longer than expected
  /// Information age [s]: how old the knowledge of its motion is. That is the time that a state
  /// takes to arrive, since the neighbour would have published one had it turned; on a degraded
  /// link, for one that moves nearby, the time since its last state.
  double stale_s = 0.0;
  /// Possible-stop age [s]: for how long it may have been stopped by now, had its process stalled
  /// right after its last state.
  double stalled_s = 0.0;
};

}  // namespace swarm::agent
