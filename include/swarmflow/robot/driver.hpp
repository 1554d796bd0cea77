// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/result.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::agent {

/// What a driver knows of its robot at one tick. World frame ENU, metres.
struct Measurement {
  /// Position of the robot's centre as sensed, noise included: the only position the agent uses
  /// [m].
  Vec2 position_m = Vec2::Zero();
  /// False while the driver has no position to rely on; `position_m` is then the last one it had.
  /// The robot is commanded to stop, an event reports it, and its neighbours receive that last
  /// position with velocity 0; without any it publishes nothing.
  bool is_valid = true;
  /// Time since the position was sensed. A position older than robots.pose_timeout_s is none. Of a
  /// younger one with a measured velocity the agent assumes that the body moved on with it.
  Duration age{};
  /// Covariance of the position [m²]. With a standard deviation along some axis above
  /// robots.pose_sigma_max_m the position is none. Empty: not known, and not tested.
  std::optional<Mat2> covariance_m2{};
  /// Measured velocity [m/s], to be set for a body that does not reach a commanded velocity at
  /// once: it is what neighbours receive. Empty: neighbours receive the commanded velocity.
  std::optional<Vec2> velocity_mps{};
  /// Heading in [−π, π], counter-clockwise from the x axis. Not used by the agent so far.
  std::optional<double> heading_rad{};
  /// Height above the ground of the mission [m], of a robot that flies. Not used by the agent so
  /// far.
  std::optional<double> height_m{};
  /// True position if it is known, as in a simulation: recorded in the robot log instead of
  /// position_m, and not seen by the control method [m].
  std::optional<Vec2> true_position_m{};
  /// Whether the last command ran out since the last measurement, so that the body began to stop
  /// by itself: the control loop was late. The next two members are read only then.
  bool command_expired = false;
  SteadyTime expired_at{};                 ///< when the command ran out
  Vec2 expired_position_m = Vec2::Zero();  ///< true position at that time, for the robot log [m]
};

/// How a robot is to stop. The agent requests kHold only, so far; a driver must not fail on the
/// others.
enum class StopKind : std::uint8_t {
  kHold,  ///< stay in place, ready to continue: brake, hover
  kLand,  ///< end safely: land, sit down, park
  kKill,  ///< cut the motors now; may not be undone
};

/// What a robot does before and after it moves. One on the ground is ready as it stands.
enum class Manoeuvre : std::uint8_t {
  kArm,      ///< let the motors turn
  kDisarm,   ///< lock them; refused while it flies
  kTakeOff,  ///< rise to the height of its driver's options and hover
};

/// What a body can do, as its driver states it. Used by `swarm_launcher check-driver` alone, so
/// far.
struct BodyAbilities {
  bool flies = false;                           ///< has to take off and to land
  bool reverses = true;                         ///< can move without turning to where it goes
  std::optional<double> speed_max_mps{};        ///< largest speed [m/s]; empty: not known
  std::optional<double> acceleration_mps2{};    ///< largest acceleration [m/s²]
  std::optional<double> turn_rate_max_radps{};  ///< largest turn rate [rad/s]
  /// Longest time from the end of a command to rest.
  Duration stops_within = std::chrono::seconds(1);
};

/// A driver's report of its robot's state. The agent reports level and text; the rest is used by
/// `swarm_launcher check-driver` alone, so far.
struct DriverHealth {
  /// Severity. A level other than kGood is reported as an event `robot-fault`; the robot goes on.
  enum class Level : std::uint8_t {
    kGood,      ///< works
    kDegraded,  ///< works with restrictions, as with a low battery
    kFailed     ///< does not work
  };
  Level level = Level::kGood;       ///< how bad it is
  std::string text{};               ///< what is wrong, one line; needed where `level` is not kGood
  std::optional<double> battery{};  ///< charge, 0 to 1; empty: not measured
  std::optional<double> battery_v{};  ///< voltage [V]; empty: not measured
  std::optional<bool> is_armed{};     ///< empty: needs no arming
  std::optional<bool> is_flying{};    ///< empty: does not fly
  /// Time since the robot was received last.
  Duration silence{};
};

/// The interface to one robot's body: simulated robots and the drivers of real ones implement it.
/// The extension point of `robots.model` (driver_registry.hpp).
///
/// Contract: a command is a velocity in the world frame that is valid for a limited time; a body
/// whose command ran out stops by itself, as by the watchdog of a mobile base. The safety filter's
/// guarantees rest on that and on the measured position.
///
/// Calls, all from the thread of the control loop:
///
///   start()                      once, before the first tick
///   abilities()                  after start()
///   measure(), then command()    once each in every control period (1/control.rate_hz)
///   measure(), then stop()       instead, after an emergency stop or a failed control method
///   health()                     at most every tenth tick
///   begin()                      between ticks, when an operator or the mission demands it
///   shutdown()                   once, at the end or after a failed start()
///
/// No call may block: one control loop serves all robots of a process, and a late tick lets
/// commands run out. A driver that waits for its robot does so in a thread of its own and hands
/// over the newest data. No call may throw: an exception ends the process with exit code 2, without
/// shutdown().
class Driver {
 public:
  /// Called after shutdown().
  virtual ~Driver() = default;

  /// Connects to the robot; the only call that may take time: the launcher waits for the robot, up
  /// to `launcher.quorum_timeout_s`. By default nothing.
  /// \return an error to end the robot's process with its message
  virtual Result<void> start() { return {}; }

  /// The newest measurement. Called once at the begin of every tick, with non-decreasing `now`.
  virtual Measurement measure(SteadyTime now) = 0;

  /// Commands a velocity; replaces the last command.
  /// \param now time of the tick, as passed to measure()
  /// \param velocity_mps finite velocity, world frame, as the safety filter allows it [m/s]
  /// \param valid_for time from `now` after which the body stops by itself: two control periods
  virtual void command(SteadyTime now, const Vec2& velocity_mps, Duration valid_for) = 0;

  /// Stops the robot. Called in every control period while the stop is in force, instead of
  /// command(), so that a lost order is repeated; must be idempotent. By default commands zero
  /// velocity for 1 s.
  virtual void stop(SteadyTime now, StopKind kind);

  /// The robot's state. By default good.
  virtual DriverHealth health() const { return {}; }

  /// What the body can do; the same after each start(). By default a body on the ground whose
  /// limits are not known.
  virtual BodyAbilities abilities() const { return {}; }

  /// Begins a manoeuvre; health() reports when it has been carried out. May be called again while
  /// that is not so. By default nothing, as for a body that is ready as it stands.
  /// \return an error that names why the robot refuses
  virtual Result<void> begin(Manoeuvre /*what*/) { return {}; }

  /// Disconnects, with the robot at rest or commanded to stop. Must also work after a failed
  /// start(). By default nothing.
  virtual void shutdown() {}
};

inline void Driver::stop(SteadyTime now, StopKind /*kind*/) {
  command(now, Vec2::Zero(), std::chrono::seconds(1));
}

}  // namespace swarm::agent
