// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "swarm_link/channels/launcher_beat.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/mission/scene.hpp"

namespace swarm::agent {

/// When a robot that is not received may be taken for a healthy robot somewhere else.
struct WhereaboutsOptions {
  std::uint32_t robots = 0;     ///< of the mission
  std::uint64_t run = 0;        ///< whose beats count
  Duration beat_timeout{};      ///< a longer time between two beats is a gap
  Duration launcher_silence{};  ///< without a beat for longer, the launcher is lost
  Duration clock_skew{};        ///< a beat that was sent longer ago, or so far ahead, is refused
  /// Without a gap for this long, a robot that the launcher has not received for all that time
  /// would have been listed as silent.
  Duration healthy_after{};
  /// In a beat that was sent this long after its last status, a robot would be listed as late.
  Duration alive_after{};
};

/// What launcher and scene state about robots that are not received: which are obstacles, and which
/// the launcher receives. Shared by the robots of a process. Pure; the time is passed in.
class Whereabouts {
 public:
  explicit Whereabouts(const WhereaboutsOptions& options);

  /// Takes a beat. One of another run, out of order, by a clock that is off, with ids that the
  /// mission does not have or with numbers that are not finite is ignored and counted. O(silent and
  /// late robots).
  /// \param sent when it was sent
  /// \return whether it was taken
  bool on_beat(const link::LauncherBeat& beat, SteadyTime now, SteadyTime sent);
  /// Takes the scene, for the robots whose bodies are obstacles. O(obstacles).
  void on_scene(const Scene& scene);

  /// Whether a robot's body is an obstacle of the scene.
  bool is_obstacle(RobotId robot) const { return obstacle_radius_m(robot).has_value(); }
  /// Radius [m] of the circle that covers its body; empty if it is no obstacle. O(log bodies).
  std::optional<double> obstacle_radius_m(RobotId robot) const;
  /// Whether the launcher has received a robot whose last state received here was measured at
  /// `last_state` since then: it is well, somewhere else. This takes `healthy_after` of beats
  /// without a gap up to now, none of which lists the robot.
  bool is_well(RobotId robot, SteadyTime last_state, SteadyTime now) const;
  /// Whether the launcher has received a status that the robot sent after `last_state`: the last
  /// beat, sent late enough, does not list it as late or silent. This is known sooner than
  /// is_well().
  bool is_alive(RobotId robot, SteadyTime last_state, SteadyTime now) const;

  /// Whether the launcher may lack the robot's next status: the last beat lists the robot as late
  /// or silent, or does not list all who are late, or is out of date.
  bool may_be_late(RobotId robot, SteadyTime now) const;

  /// Whether beats had been received and have stopped.
  bool is_launcher_lost(SteadyTime now) const {
    return last_beat_ && now - *last_beat_ > options_.launcher_silence;
  }
  /// Whether beats have stopped, or came back less than `within` ago: the launcher may not have
  /// run, and with it the discovery server.
  bool had_gap(Duration within, SteadyTime now) const {
    return (last_beat_ && now - *last_beat_ > options_.beat_timeout) ||
           (back_at_ && now - *back_at_ <= within);
  }
  /// Of the last beat; empty: none has been received.
  std::optional<SteadyTime> last_beat() const { return last_beat_; }
  std::uint64_t refused() const { return refused_; }

 private:
  bool is_valid(const link::LauncherBeat& beat) const;
  bool is_newer(const link::LauncherBeat& beat, SteadyTime now, SteadyTime sent) const;

  WhereaboutsOptions options_;
  std::optional<SteadyTime> last_beat_;
  SteadyTime since_;                     // of the first beat after the last gap
  std::optional<SteadyTime> back_at_{};  // the same, if there has been a gap
  std::uint64_t sequence_ = 0;
  std::uint64_t refused_ = 0;
  std::vector<SteadyTime> listed_at_;   // by robot: the last beat that lists it
  SteadyTime complete_sent_;            // of the last beat, if it lists all late and silent robots
  bool lists_all_late_ = false;         // whether the last beat does
  std::vector<std::uint64_t> late_in_;  // by robot: the last beat that lists it as late or silent
  struct Body {
    RobotId robot;
    double radius_m;
  };
  std::vector<Body> bodies_;  // sorted by robot
};

/// The options of a mission. The launcher reports a robot as silent `launcher_silence` after its
/// last status.
WhereaboutsOptions whereabouts_options(const Mission& mission, std::uint64_t run);

}  // namespace swarm::agent
