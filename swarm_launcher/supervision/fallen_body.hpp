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
  /// From its steps: the velocity commanded at that time, and its mean speed since the control
  /// period before. Without them the robot may have moved in any direction, at its largest speed.
  std::optional<Vec2> command_mps{};
  std::optional<double> speed_mps{};
  bool at_rest = false;  ///< arrived and settled: it does not move
  /// However old this is, the robot has not driven on: its process has ended or is frozen, or it
  /// stands. A process that wakes stands until it has received the others (MotionPermit), and is
  /// received itself.
  bool is_last = false;
};

/// From the last steps of a robot, newest last. Empty if there are none.
std::optional<LastKnown> last_known(std::span<const robot_log::Step> steps, const Mission& mission);

/// A robot whose last step is not older makes steps.
Duration longest_between_steps(const Mission& mission);

/// A circle that covers the body of a robot from its last known position to where its driver stops
/// it. A command is valid for two control periods; then the robot brakes. The less is known, the
/// larger is the circle. After the robot's last step it covers the motion under the command of that
/// step only. A robot that makes steps may be cut off and drive on at the largest speed until it
/// holds, at most a period of its statuses and `planner_silence_s`: the circle covers that. By a
/// status it covers as much, but not more than the age of the status.
Circle circle_of_fallen(const LastKnown& known, UtcTime now, const Mission& mission, RobotId robot);

}  // namespace swarm::launcher
