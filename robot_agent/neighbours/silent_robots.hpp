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

/// A robot that may be anywhere near a segment: its body is within `radius_m` of a point of it.
struct SilentRobot {
  RobotId robot;
  Vec2 from_m = Vec2::Zero();
  Vec2 to_m = Vec2::Zero();
  double radius_m = 0.0;
  double growth_mps = 0.0;  ///< of the radius; 0: it stands
};

/// The robots that were received once, by this process, and are not any more. Silence is never free
/// space: a silent robot is at each of its possible positions until it is received again, from
/// wherever, or the launcher receives it elsewhere; while its body is an obstacle of the scene, it
/// is there (see Whereabouts).
///
/// A robot whose last state has position p and velocity v is, at age α, within
///
///   ‖x − p‖ ≤ v_max min(α, σ + D),   D = planner silence + 2 Δt + λ
///
/// v_max is its largest speed; σ the expected silence, at the end of which it has been cut off at
/// the latest. After that nothing is known of what it does, but for how long it can do it: a
/// process that ends or freezes commands nothing, and its body stands 2 Δt and its lag λ later; one
/// that is cut off from planner and launcher stands after the silence (MotionPermit). Up to σ it
/// counts as extrapolated, since it would have published had it left its course; from σ to 2σ the
/// set grows at 2 v_max from p … p + σv to the circle above. Two limits: within σ of the moment at
/// which a robot is cut off others cannot know that it has turned; and one that is not received
/// but receives the others goes on, and keeps off them by itself (SafetyFilter, 3). A robot that
/// froze before it was received for the first time is known to the launcher alone, which makes its
/// body an obstacle.
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

  /// Whether a robot is looked after here: not one of this process, whose robots share its fate.
  bool covers(RobotId robot) const {
    // Ids below the first own one wrap around to large offsets.
    const std::uint32_t id = robot.value();
    return id < index_of_.size() && id - options_.first_own >= options_.own;
  }

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
