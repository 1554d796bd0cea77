// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "swarm_link/channels/launcher_beat.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// The robots whose next status is late, for the launcher's beats: a robot that approaches one of
/// them without having received it would take its place for free. A robot is late from
/// late_status() after its last status on; once it is reported as silent, its body is an obstacle
/// of the scene, and three seconds later it is late no more. Pure; the times are passed in.
class LateRobots {
 public:
  LateRobots(std::uint32_t robots, double status_hz);

  /// A status, which was received at `now`, of a position that was measured at `measured`.
  void on_status(RobotId robot, const Vec2& position_m, SteadyTime measured, SteadyTime now);

  /// Those that are late at `now`, the newest positions first; valid until the next call.
  /// O(robots).
  std::span<const link::LateRobot> at(SteadyTime now);

 private:
  struct Last {
    bool is_known = false;
    SteadyTime received;
    SteadyTime measured;
    Vec2 position_m = Vec2::Zero();
  };

  Duration from_;
  Duration to_;
  std::vector<Last> last_;
  std::vector<link::LateRobot> late_;
};

}  // namespace swarm::launcher
