// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "swarm_launcher/flight/flight_ports.hpp"

namespace swarm::launcher {

/// Robots that are not received any more: their bodies become obstacles of the scene for the
/// others, where they were last known to be, and cease to be when they are received again.
class FallenRobots {
 public:
  /// `robots_here`: the first robots, whose logs are on this host. `log_delay`: by how much a log
  /// may end before the last status. `logged`: by the robot's log. \pre all references outlive the
  /// object
  FallenRobots(const Mission& mission, SceneKeeper& scene, FlightLog& log,
               std::uint32_t robots_here, Duration log_delay, LoggedPosition logged);

  /// A robot reported its position.
  void on_status(RobotId robot, const LastKnown& reported) {
    reported_.at(robot.value()) = reported;
  }

  void add(std::span<const RobotId> robots, UtcTime now);
  /// Their logs are known better than before: bodies become smaller where that follows.
  void narrow(std::span<const RobotId> robots, UtcTime now);
  void clear(std::span<const RobotId> robots, UtcTime now);

 private:
  /// The newer of log and status.
  const std::optional<LastKnown>& newest_of(RobotId robot,
                                            const std::optional<LastKnown>& logged) const;
  void report_incomplete_log(RobotId robot, const std::optional<LastKnown>& logged, UtcTime now);

  const Mission& mission_;
  SceneKeeper& scene_;
  FlightLog& log_;
  std::uint32_t robots_here_;
  Duration log_delay_;
  LoggedPosition logged_;
  std::vector<std::optional<LastKnown>> reported_;  // by the newest status of each robot
};

}  // namespace swarm::launcher
