// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "robot_agent/neighbours/whereabouts.hpp"
#include "swarm_core/mission/fleet.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/mission.hpp"

namespace swarm::agent {

/// The times that bound where a silent robot may be.
struct SilenceOptions {
  Fleet fleet;  ///< sizes and speeds of all robots
  std::uint32_t robots = 0;
  std::uint32_t first_own = 0;  ///< the robots of this process are never silent to each other
  std::uint32_t own = 0;        ///< number of them
  Duration expected_silence{};  ///< σ: a healthy robot publishes at least this often
  Duration dead_man{};          ///< D: a robot that is cut off stands at the latest after this time
};

/// A robot that may be anywhere within a circle.
struct SilentRobot {
  RobotId robot;
  Vec2 center_m = Vec2::Zero();
  double radius_m = 0.0;  ///< of the circle that contains its body
};

/// The robots that were received once, by this process, and are not any more. Silence is never free
/// space: a silent robot is at each of its possible positions until it is received again, from
/// wherever, or is known to be elsewhere (see Whereabouts).
///
/// A robot whose last state has position p and velocity v is, at age α > σ, within
///
///   ‖x − (p + σ v)‖ ≤ v_max min(α − σ, D),   D = planner silence + 2 Δt + λ
///
/// v_max is its largest speed. Up to σ it would have published had it left its extrapolation by
/// more than the tolerated error. After that nothing is known of what it does, but for how long it
/// can do it: a process that ends or freezes commands nothing, and its body stands 2 Δt and its lag
/// λ later; one that is cut off from planner and launcher stands after the silence (MotionPermit).
/// One that is not received but receives the others keeps off them by itself. What no process can
/// know by itself is a robot that froze before it was received for the first time: the launcher
/// makes its body an obstacle.
///
/// Shared by the robots of a process. Pure; the time is passed in. No allocation once made.
class SilentRobots {
 public:
  explicit SilentRobots(const SilenceOptions& options);

  /// A state that was received, of any robot. Older ones than the last change nothing. O(1).
  struct State {
    RobotId robot;
    SteadyTime as_of;
    Vec2 position_m = Vec2::Zero();
    Vec2 velocity_mps = Vec2::Zero();
  };
  void on_state(const State& state);

  /// Finds those that are silent now, once a tick. O(robots received and not cleared).
  void update(SteadyTime now, const Whereabouts& whereabouts);

  /// As of the last update(), in the order in which they were received for the first time.
  std::span<const SilentRobot> all() const { return silent_; }

 private:
  SilentRobot possible_positions(const State& state, Duration age) const;

  SilenceOptions options_;
  std::vector<State> received_;          // of each robot the last state
  std::vector<std::uint32_t> index_of_;  // in received_, by robot; kNone: not received
  std::vector<SilentRobot> silent_;
};

/// The options of a process of a mission.
SilenceOptions silence_options(const Mission& mission, RobotId first, std::uint32_t count);

}  // namespace swarm::agent
