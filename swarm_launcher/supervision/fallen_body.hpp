// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "swarm_core/robot_log/record.hpp"
#include "swarmflow/mission/mission.hpp"
#include "swarmflow/mission/scene.hpp"

namespace swarm::launcher {

/// The newest that is known of where a robot was, before it was not received any more.
struct LastKnown {
  UtcTime at{};
  Vec2 position_m = Vec2::Zero();
  /// By its log: commanded then, and how fast it was on the average since the tick before. Without
  /// it may have moved anywhere, as fast as it can.
  std::optional<Vec2> command_mps{};
  std::optional<double> speed_mps{};
  bool at_rest = false;  ///< arrived and settled: it does not move
};

/// By the last steps of a robot's log, newest last. Nothing if there are none.
std::optional<LastKnown> last_known(std::span<const robot_log::Step> steps, const Mission& mission);

/// Where a robot's body is that is not received since a time: a circle that covers its positions
/// from the last known one to where its driver stops it. A command is valid for two control
/// periods; then the robot brakes. The less is known the larger the circle: with the command of the
/// last tick it covers that command alone, without it every direction at the largest speed, for as
/// long as the information is old, at most a period of its statuses.
Circle circle_of_fallen(const LastKnown& known, UtcTime silent_since, const Mission& mission,
                        RobotId robot);

}  // namespace swarm::launcher
