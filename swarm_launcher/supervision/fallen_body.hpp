// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "swarm_core/robot_log/record.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/mission/scene.hpp"

namespace swarm::launcher {

/// The newest known position of a dead or silent robot.
struct LastKnown {
  UtcTime at{};
  Vec2 position_m = Vec2::Zero();
  /// From its log: the velocity commanded at that time, and its mean speed since the control period
  /// before. Without them the robot may have moved in any direction, at its largest speed.
  std::optional<Vec2> command_mps{};
  std::optional<double> speed_mps{};
  bool at_rest = false;  ///< arrived and settled: it does not move
  bool is_last = false;  ///< its process has ended: however old this is, no step followed
};

/// From the last steps of a robot's log, newest last. Empty if there are none.
std::optional<LastKnown> last_known(std::span<const robot_log::Step> steps, const Mission& mission);

/// A circle that covers the body of a robot from its last known position to where its driver stops
/// it. `silent_since`: when its silence began. A command is valid for two control periods;
/// then the robot brakes. The less is known, the larger is the circle: with the command of the last
/// period it covers the motion under that command only; otherwise every direction at the largest
/// speed for the age of the information, at most a period of its statuses, and without its log also
/// the time after which a robot that is cut off holds.
Circle circle_of_fallen(const LastKnown& known, UtcTime silent_since, const Mission& mission,
                        RobotId robot);

}  // namespace swarm::launcher
