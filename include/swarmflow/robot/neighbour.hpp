// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/linalg.hpp"

namespace swarm::agent {

/// A robot's estimate of another robot at the present tick, from the state updates received.
struct Neighbour {
  RobotId robot;                     ///< its number
  Vec2 position_m = Vec2::Zero();    ///< extrapolated linearly from its last state update [m]
  Vec2 velocity_mps = Vec2::Zero();  ///< as published in its last state update [m/s]
  /// Its radius [m]; grown by its largest speed for every second that its next state update is
  /// overdue (link.send_interval_max_s and two control periods).
  double radius_m = 0.0;
  /// Information age of its motion [s]: the transit time of its state updates, since it would have
  /// published another one had it turned; on a degraded link, for a robot that moves nearby, the
  /// time since its last state update.
  double information_age_s = 0.0;
  /// Possible-stop age [s]: how long it may have been at rest by now if its process stalled right
  /// after its last state update and its last command ran out. 0 for a recent state update.
  double possible_stop_age_s = 0.0;
  /// It is not received any more: `position_m` and `radius_m` are of a disc that its body is in.
  bool is_silent = false;
};

}  // namespace swarm::agent
