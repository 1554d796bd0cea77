// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/route/guide_points.hpp"

#include <algorithm>

#include "swarm_core/base/assert.hpp"

namespace swarm::agent {
namespace {

constexpr double kReached_m = 0.3;  // reached, even if the next point is not in sight

}  // namespace

GuidePoints::GuidePoints(const Polyline& path, Shared<GuidePointsOptions> options)
    : options_(std::move(options)), points_m_(path.vertices_m()) {
  SWARM_ASSERT(!points_m_.empty());
  behind_m_.assign(points_m_.size(), 0.0);
  for (std::size_t i = points_m_.size() - 1; i > 0; --i) {
    behind_m_[i - 1] = behind_m_[i] + (points_m_[i] - points_m_[i - 1]).norm();
  }
}

/// Line of sight to a point, as wide as body and clearance.
bool GuidePoints::sees(const Vec2& position_m, const World& world, std::size_t point,
                       double clearance_m) const {
  // The width of the line of sight is at most the clearance at its two ends: a robot near a wall
  // still sees points in the open.
  const double least_m = std::min({world.distance_m(position_m), world.distance_m(points_m_[point]),
                                   options_->radius_m + clearance_m});
  return world.segment_is_free(position_m, points_m_[point],
                               std::max(0.0, least_m - options_->scale * 1e-3));
}

/// Takes the first of these that is in sight:
///
///   1. the farthest later point with full clearance
///   2. the present point
///   3. the farthest later point through any passable gap
///   4. outside the goal: the last earlier point
void GuidePoints::look(const Vec2& position_m, const World& world, bool in_goal) {
  std::size_t last = at_;
  while (last + 1 < points_m_.size() && behind_m_[at_] - behind_m_[last + 1] < options_->sight_m) {
    ++last;
  }
  const auto take_if_seen = [&](std::size_t point, double clearance_m) {
    if (!sees(position_m, world, point, clearance_m)) return false;
    at_ = point;
    return true;
  };
  for (std::size_t i = last; i > at_; --i) {
    if (take_if_seen(i, options_->clearance_m)) return;
  }
  if (sees(position_m, world, at_, options_->passable_m)) return;
  // Onwards through a narrow gap rather than back: otherwise a robot in the gap would oscillate.
  for (std::size_t i = last; i > at_; --i) {
    if (take_if_seen(i, options_->passable_m)) return;
  }
  if (in_goal) return;
  for (std::size_t i = at_; i > 0; --i) {
    if (take_if_seen(i - 1, options_->passable_m)) return;
  }
}

/// Looks only every few ticks, as lines of sight are costly; reaching a point is checked at each.
const Vec2& GuidePoints::update(const Vec2& position_m, const World& world, bool in_goal) {
  if (looks_in_-- == 0) {
    looks_in_ = options_->look_every - 1;
    look(position_m, world, in_goal);
  }
  const double distance_m = (points_m_[at_] - position_m).norm();
  if (!is_last() && distance_m < options_->goal_radius_m &&
      (distance_m < options_->scale * kReached_m ||
       sees(position_m, world, at_ + 1, options_->passable_m))) {
    ++at_;
  }
  return points_m_[at_];
}

}  // namespace swarm::agent
