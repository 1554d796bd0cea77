// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "swarm_monitor/audit/recorded_run.hpp"
#include "swarmflow/mission/scene.hpp"

/// Surface-to-surface gaps of the recorded motion, exact in continuous time: between two points a
/// robot moves in a straight line, so the nearest approach lies anywhere, not only at the ticks.
namespace swarm::monitor {

/// Nearest approach of two bodies, surface to surface; negative gaps are overlaps.
struct Approach {
  double gap_m = std::numeric_limits<double>::infinity();
  double time_s = 0.0;
  Vec2 at_m = Vec2::Zero();  ///< the first robot's centre
  std::uint32_t robot = 0;
  std::uint32_t other = 0;  ///< a robot, or an index into World::obstacles()
};

/// Gaps of a run. Time is cut into windows of kWindow_s from 0 on.
struct Clearance {
  static constexpr double kWindow_s = 1.0;
  /// Gaps of single windows are known up to here; larger ones count as this.
  static constexpr double kCap_m = 2.0;

  Approach nearest;                ///< +∞ when nothing ever was near anything
  std::vector<Approach> contacts;  ///< deepest approach of each pair that touched (gap ≤ 0)
  /// The same for pairs of which one was dead; they enter no other member.
  std::vector<Approach> fallen_contacts;
  std::vector<double> by_window_m;
  std::vector<double> by_robot_m;  ///< smallest gap of each robot, at most kCap_m
};

/// Nearest approach of two tracks within [from_s, to_s]; gap +∞ if they do not overlap in time.
Approach approach_of(const Track& a, const Track& b, double from_s, double to_s);

/// The same while at least one of them is dead and its body is there (Track::body_until_s).
Approach fallen_approach_of(const Track& a, const Track& b, double from_s, double to_s);

/// Smallest gap of one straight piece of motion to a convex obstacle, and the share of the piece at
/// which it is reached. Signed distance to a convex set is convex along a line: golden section
/// finds it to 1e-9 m.
std::pair<double, double> approach_of(const Vec2& from_m, const Vec2& to_m, double radius_m,
                                      const ConvexObstacle& obstacle);

/// Robots against robots. A grid is the broad phase: every pair with a gap up to the search radius
/// is looked at, and the radius grows until the nearest pair lies within it, so the result is the
/// same as that of comparing all pairs.
Clearance robot_clearance(std::span<const Track> tracks);

/// Robots against the obstacles of each phase of the map, moving ones included: between two points
/// of a track and within a phase both move evenly, so that the robot is seen to move straight past
/// an obstacle that stands. `begin` is time 0 of the tracks. \pre some phase
Clearance obstacle_clearance(std::span<const Track> tracks, std::span<const WorldPhase> phases,
                             UtcTime begin);

}  // namespace swarm::monitor
