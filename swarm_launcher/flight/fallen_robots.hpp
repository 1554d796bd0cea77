// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

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
  using Logged = std::function<std::optional<LastKnown>(RobotId)>;

  /// `logged`: by the robot's log. \pre all references outlive the object
  FallenRobots(const Mission& mission, SceneKeeper& scene, FlightLog& log, Logged logged);

  /// A robot reported its position.
  void on_status(RobotId robot, const LastKnown& reported) {
    reported_.at(robot.value()) = reported;
  }

  void add(std::span<const RobotId> robots, UtcTime now);
  /// Their logs are known better than before: bodies become smaller where that follows.
  void narrow(std::span<const RobotId> robots, UtcTime now);
  void clear(std::span<const RobotId> robots, UtcTime now);

 private:
  std::optional<LastKnown> last_known_of(RobotId robot) const;

  const Mission& mission_;
  SceneKeeper& scene_;
  FlightLog& log_;
  Logged logged_;
  std::vector<std::optional<LastKnown>> reported_;  // by the newest status of each robot
};

}  // namespace swarm::launcher
