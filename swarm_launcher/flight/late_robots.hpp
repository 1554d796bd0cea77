// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "swarm_link/channels/launcher_beat.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// The robots whose next status is late, for the launcher's beats: a robot that approaches one of
/// them without having received it would take its place for free. A robot is late when its last
/// status is older than late_status(), until it has been silent for three seconds longer than it
/// takes to be reported as such: then its body has been an obstacle of the scene for long. Pure;
/// the times are passed in.
class LateRobots {
 public:
  LateRobots(std::uint32_t robots, double status_hz);

  /// A status, which was received at `now`, of a position that was measured at `measured`.
  void on_status(RobotId robot, const Vec2& position_m, SteadyTime measured, SteadyTime now);

  /// Fills in those that are late at `now`; of more than a beat has room for others at each call.
  /// After a gap of more than a second between two calls the launcher was suspended: statuses that
  /// have arrived since may not have been read yet, so that for a while it states nothing.
  /// O(robots).
  void list(SteadyTime now, link::LauncherBeat& beat);

 private:
  struct Last {
    bool is_known = false;
    SteadyTime received;
    SteadyTime measured;
    Vec2 position_m = Vec2::Zero();
  };

  Duration from_;
  Duration to_;
  std::optional<SteadyTime> listed_at_{};  // last call
  SteadyTime silent_until_;                // after a gap
  std::size_t next_ = 0;                   // first of the next beat, where there are too many
  std::vector<Last> last_;
  std::vector<link::LateRobot> late_;
};

}  // namespace swarm::launcher
