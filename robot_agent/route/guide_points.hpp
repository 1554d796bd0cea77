// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "swarm_core/base/shared.hpp"
#include "swarmflow/core/world.hpp"
#include "swarmflow/robot/route.hpp"

namespace swarm::agent {

/// When a point is reached, and what counts as in sight.
struct GuidePointsOptions {
  double radius_m = 0.2;
  double passable_m = 0.06;      ///< least surface clearance that the safety filter lets pass
  double goal_radius_m = 1.0;    ///< an intermediate goal this near is reached
  double clearance_m = 0.3;      ///< surface clearance of a line of sight to a later one
  double sight_m = 12.0;         ///< later ones are looked for this far ahead on the path
  std::uint32_t look_every = 4;  ///< ticks between two looks
  double scale = 1.0;            ///< of the other distances (body_scale.hpp)
};

/// The intermediate goals of a path and which of them is the robot's present one [CRoPS, guiding
/// the swarm through the shortest roadmap path]: the vertices of its path, its own points in the
/// Gaussians of the guide, so that a hundred robots do not all pass through the same points. The
/// last one is its slot in the goal.
///
/// A robot goes on to the next one within goal_radius_m, and to the farthest one within sight_m
/// that is in line of sight. Pushed off so far that its present one is hidden, it goes on to one
/// that it sees through any gap, and if there is none falls back to the last one that it sees; not
/// from within the goal, where a robot that is pushed aside finds a slot anyway.
class GuidePoints {
 public:
  GuidePoints() = default;
  GuidePoints(const Polyline& path, Shared<GuidePointsOptions> options);

  /// The point to go to from this position. No allocation. \pre the path was not empty
  const Vec2& update(const Vec2& position_m, const World& world, bool in_goal = false);

  const Vec2& end_m() const { return points_m_.back(); }
  bool is_last() const { return at_ + 1 == points_m_.size(); }
  /// Path left from a position through the present intermediate goal to the end [m].
  double remaining_m(const Vec2& position_m) const {
    return (points_m_[at_] - position_m).norm() + behind_m_[at_];
  }

 private:
  bool sees(const Vec2& position_m, const World& world, std::size_t point,
            double clearance_m) const;
  void look(const Vec2& position_m, const World& world, bool in_goal);

  Shared<GuidePointsOptions> options_;
  std::vector<Vec2> points_m_;
  std::vector<double> behind_m_;  // path length from each point to the end
  std::size_t at_ = 0;
  std::uint32_t looks_in_ = 0;
};

}  // namespace swarm::agent
