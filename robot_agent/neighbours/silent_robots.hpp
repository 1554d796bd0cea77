// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
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
  /// By robot: up to this radius, the circle of its body shows that it froze.
  std::vector<double> frozen_body_radius_m{};
  Duration expected_silence{};  ///< σ: a healthy robot publishes at least this often
  Duration expected_status{};   ///< P: and its status at least this often
  Duration dead_man{};          ///< D: a robot that is cut off stands at the latest after this time
};

/// A robot whose body is somewhere in a disc.
struct SilentRobot {
  RobotId robot;
  Vec2 centre_m = Vec2::Zero();
  double radius_m = 0.0;
  double growth_mps = 0.0;  ///< of the radius; 0: the robot stands by now
};

/// The robots that were received once, by this process or by the launcher, and are not any more.
/// Silence is never free space: a silent robot is at each of its possible positions until it is
/// received again, from wherever, or the launcher receives it elsewhere.
///
/// While its body is an obstacle of the scene, it is there (see Whereabouts). That obstacle is a
/// circle, by the robot's last step around the position at which it froze. A circle wider than
/// frozen_body_radius_m is that of a robot which may have been cut off and have driven on: it is
/// silent as without the obstacle, for 15 s: then robots inside the circle leave it.
///
/// A robot whose last state lies in a cell that the process does not receive has not fallen silent:
/// it has left, or was left behind. If it is healthy, it is received again before it is near. It is
/// silent once the process has received that cell for σ, and not the robot; its disc has its full
/// size then. It is forgotten before if the launcher has received it since. A disc that exists
/// stays, whatever the process receives.
///
/// A robot that falls silent before this process receives it is known from the launcher's beats:
/// they list where a robot was whose next status is late. It is treated as if its state had been
/// received at that time, with P, the period of its statuses, for σ in the bound below. It is
/// forgotten when the launcher receives it again.
///
/// A robot whose last state has position p is, at age α, within
///
///   ‖x − p‖ ≤ v_max min(α, σ + D),   D = planner silence + σ + 2 Δt + λ
///
/// v_max is its largest speed; σ the expected silence, up to which it counts as extrapolated, and
/// at the end of which it has been cut off at the latest. After that nothing is known of what it
/// does, but for how long it can do it: a process that ends or freezes commands nothing, and its
/// body stands 2 Δt and its lag λ later; one that is cut off from planner and launcher stands after
/// the planner's silence (MotionPermit), or it is connected again before and publishes within σ.
///
/// Each robot keeps out of this disc while it is outside, and stands while it is within
/// (SafetyFilter::stand):
///
/// 1. Outside. The disc grows no faster than v_max, so that a robot as fast as that can retreat
///    from it in the open. Whatever the silent robot does, the two do not touch.
/// 2. Within. The silent robot may be on any side: no motion leads away from it for certain, and
///    any can be the one that hits it. Standing is right towards each robot that keeps this
///    protocol. Frozen: it stands as well. Not received, but receiving: it keeps off by itself, and
///    off a robot at rest most easily. Cut off: it does not receive us either, and is outside of
///    our disc and stays there, or is within and stands.
///
/// So two robots that do not receive each other touch only if they are within each other's disc;
/// then both stand, and did not come to touch. What remains: within σ of the moment at which a
/// robot is cut off, neither can know that the other has turned; robots that cannot retreat, for
/// walls or others, may be overtaken by the disc, and then stand; a silent robot that follows no
/// protocol can reach those within. One whose states alone are lost drives on, as the launcher
/// receives it: it keeps off those that it receives, but two of them can meet beyond their discs. A
/// robot that is cut off drives for up to σ + D, and others that have not received it learn of it
/// from a beat, a status period or two later: cells are joined half a metre (groups) or six
/// (topics) beyond the communication radius.
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
  };
  void on_state(const State& state);

  /// The late robots of a beat that Whereabouts has taken, and when it was sent. O(late robots).
  void on_beat(const link::LauncherBeat& beat, SteadyTime sent);

  /// Whether the states of a robot at a position are received. Empty: everywhere.
  using ReceivesAt = std::function<bool(const Vec2& position_m)>;

  /// Finds those that are silent now, once a tick. O(robots received and not cleared).
  void update(SteadyTime now, const Whereabouts& whereabouts, const ReceivesAt& receives_at = {});

  /// Whether a robot is looked after here: not one of this process, whose robots share its fate.
  bool covers(RobotId robot) const {
    // Ids below the first own one wrap around to large offsets.
    const std::uint32_t id = robot.value();
    return id < index_of_.size() && id - options_.first_own >= options_.own;
  }

  /// As of the last update(), in the order in which they were received for the first time.
  std::span<const SilentRobot> all() const { return silent_; }

 private:
  struct Received {
    State last;
    SteadyTime missed_since;  // its cell has been received since then, but not the robot
    bool is_silent = false;
    bool has_left = false;     // its cell has not been received at some time since
    bool is_reported = false;  // known from the launcher's beats alone
    bool is_status = false;    // `last` is from a beat
  };
  Received& received(const State& state);
  bool is_elsewhere(const Received& robot, SteadyTime now, const Whereabouts& whereabouts) const;
  SilentRobot possible_positions(const Received& robot, Duration age) const;

  SilenceOptions options_;
  std::vector<Received> received_;
  std::vector<std::uint32_t> index_of_;  // in received_, by robot; kNone: not received
  std::vector<SilentRobot> silent_;
};

/// The options of a process of a mission.
SilenceOptions silence_options(const Mission& mission, RobotId first, std::uint32_t count);

}  // namespace swarm::agent
