// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "swarm_monitor/audit/recorded_run.hpp"

namespace swarm::monitor {

/// One living robot at a moment.
struct RobotNow {
  std::uint32_t robot = 0;
  Vec2 position_m = Vec2::Zero();    ///< between its two steps around the moment
  const TrackPoint* step = nullptr;  ///< its last step by then
};

/// Interpolates all tracks of a run at ascending moments. A robot is present from its first step
/// on, until its last one if it was lost; one that ended gracefully stays where it ended.
class SwarmWalk {
 public:
  explicit SwarmWalk(std::span<const Track> tracks);

  /// The living robots by ascending id; valid until the next call. O(robots + steps passed).
  /// \pre times never descend
  const std::vector<RobotNow>& at(double time_s);

 private:
  std::span<const Track> tracks_;
  std::vector<std::size_t> cursors_;
  std::vector<RobotNow> robots_;
};

/// First step in motion of any robot, and last step of all [s]; empty if no robot ever moved.
struct MotionSpan {
  double begin_s = 0.0;
  double end_s = 0.0;
};
std::optional<MotionSpan> motion_of(std::span<const Track> tracks);

/// Share of these robots that have arrived; 0 of none.
double arrived_share(std::span<const RobotNow> robots);

}  // namespace swarm::monitor
