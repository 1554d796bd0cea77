// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "swarm_launcher/flight/flight_ports.hpp"
#include "swarm_launcher/flight/flight_time.hpp"

namespace swarm::launcher {

/// Robots that are not received any more: their bodies become obstacles of the scene for the
/// others, where they were last known to be, and cease to be when they are received again.
class FallenRobots {
 public:
  /// The robots of this host.
  struct Here {
    std::uint32_t robots = 0;  ///< the first ones of the mission
    Duration log_delay{};      ///< robot_log::log_delay()
    /// How long the process of a robot has been running; empty: it has ended.
    std::function<std::optional<Duration>(RobotId, SteadyTime)> runs_for;
  };
  /// Period in which bodies are looked at again.
  static constexpr Duration kPeriod = std::chrono::seconds(1);

  /// \pre all references outlive the object
  FallenRobots(const Mission& mission, SceneKeeper& scene, FlightLog& log, Here here,
               RecordedPositions recorded);

  /// A robot reported its position.
  void on_status(RobotId robot, const LastKnown& reported) {
    reported_.at(robot.value()) = reported;
  }

  void add(std::span<const RobotId> robots, const FlightTime& now);
  /// Changes the bodies of which the last step is known better than before, or has changed: one
  /// that is on another host, or a robot that makes steps although it is not received. Adds those
  /// for which there was no room.
  void update(const FlightTime& now);
  void clear(std::span<const RobotId> robots, UtcTime now);

 private:
  bool is_starting(RobotId robot, SteadyTime now) const;
  bool is_last(RobotId robot, const LastKnown& step, const FlightTime& now) const;
  std::optional<LastKnown> last_step(RobotId robot, const FlightTime& now) const;
  std::optional<LastKnown> newest_of(RobotId robot, const FlightTime& now) const;
  void add_waiting(const FlightTime& now, std::vector<SceneChange>& changes,
                   std::vector<RobotId>& changed);
  void report_last_step(RobotId robot, const FlightTime& now);
  void report_incomplete_log(RobotId robot, const FlightTime& now);

  const Mission& mission_;
  SceneKeeper& scene_;
  FlightLog& log_;
  Here here_;
  RecordedPositions recorded_;
  std::vector<std::optional<LastKnown>> reported_;  // by the newest status of each robot
  std::set<RobotId> without_room_;                  // in the scene, for their bodies
  SteadyTime next_update_{};
};

}  // namespace swarm::launcher
