// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::agent {

/// What a driver knows of its robot at one moment. World frame, metres.
struct Measurement {
  Vec2 position_m = Vec2::Zero();  ///< as sensed: all that the agent knows
  /// False while the driver has no position to rely on: `position_m` is then the last one it had.
  /// The robot brakes, and its position is not published as a new one.
  bool is_valid = true;
  Duration age{};  ///< time since the position was sensed
  /// How it moves, of a body that does not have the velocity it is commanded at once: neighbours
  /// who trusted its command would drive into it.
  std::optional<Vec2> velocity_mps;
  std::optional<double> heading_rad;  ///< in [−π, π], counter-clockwise from the x axis
  /// Where it truly is, if that is known (simulations do): for the robot log, not for the agent.
  std::optional<Vec2> true_position_m;
  /// Whether the last command ran out before now, so that the body stops: a late control loop.
  bool command_expired = false;
  SteadyTime expired_at;
  Vec2 expired_position_m = Vec2::Zero();  ///< where that was, as in the robot log
};

/// How a robot is to stop.
enum class StopKind : std::uint8_t {
  kHold,  ///< stay where it is, ready to go on: brake, hover
  kLand,  ///< end safely: land, sit down, park
  kKill,  ///< cut the motors now; may not be undone
};

/// A driver's report of its robot's state of health.
struct DriverHealth {
  enum class Level : std::uint8_t { kGood, kDegraded, kFailed };
  Level level = Level::kGood;
  std::string text{};  ///< what is wrong, for an event
};

/// A robot's body: what a simulated robot and a real one's driver have in common.
///
/// Contract: a command is a velocity in the world frame, valid for a limited time; a body whose
/// command ran out stops by itself (the watchdog every mobile base has). The safety layer's promise
/// rests on it. All calls come from one thread and must not block: a driver that waits for its
/// robot does so in a thread of its own.
///
/// Life: start() once, then measure() and command() in every control period, stop() when the
/// mission demands it, shutdown() once at the end, also after a failed start().
class Driver {
 public:
  virtual ~Driver() = default;

  /// Connects to the robot. An error ends the robot's process with its message.
  virtual Result<void> start() { return {}; }

  virtual Measurement measure(SteadyTime now) = 0;

  /// `velocity_mps` holds for `valid_for`, then the body stops.
  virtual void command(SteadyTime now, const Vec2& velocity_mps, Duration valid_for) = 0;

  /// Called at each period of a stop, so that a lost one is repeated; the default commands zero.
  virtual void stop(SteadyTime now, StopKind kind);

  virtual DriverHealth health() const { return {}; }

  virtual void shutdown() {}
};

inline void Driver::stop(SteadyTime now, StopKind /*kind*/) {
  command(now, Vec2::Zero(), std::chrono::seconds(1));
}

}  // namespace swarm::agent
