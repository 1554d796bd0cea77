// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "swarm_core/base/linalg.hpp"
#include "swarm_core/base/time.hpp"

namespace swarm::agent {

struct Measurement {
  Vec2 position_m = Vec2::Zero();  ///< as sensed: all that the agent knows
  /// How it moves, of a body that does not have the velocity it is told at once: neighbours who
  /// trusted its command would drive into it.
  std::optional<Vec2> velocity_mps;
  /// Where it truly is, if anybody knows (simulations do): for the black box, not for the agent.
  std::optional<Vec2> true_position_m;
  /// Whether the last command ran out before now, so that the body stops: a late control loop.
  bool command_expired = false;
  SteadyTime expired_at;
  Vec2 expired_position_m = Vec2::Zero();  ///< where that was, as in the black box
};

/// A robot's body: what a simulated robot and a real one's driver have in common.
///
/// Contract: a command is a velocity in the world frame, valid for a limited time; a body whose
/// command ran out stops by itself (the watchdog every mobile base has). The safety layer's promise
/// rests on it. Calls come from one thread and must not block.
class Driver {
 public:
  virtual ~Driver() = default;
  virtual Measurement measure(SteadyTime now) = 0;
  virtual void command(SteadyTime now, const Vec2& velocity_mps, Duration valid_for) = 0;
};

}  // namespace swarm::agent
