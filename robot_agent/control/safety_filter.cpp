// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/control/safety_filter.hpp"

#include <algorithm>

namespace swarm::agent {

SafetyFilter::SafetyFilter(const World& world, const SafetyOptions& options)
    : world_(world), options_(options) {
  constraints_.reserve(256);
}

Vec2 SafetyFilter::filter(const Vec2& position_m, const Vec2& wish_mps,
                          std::span<const Neighbour> neighbours) {
  constraints_.clear();
  const double horizon_s = 2.0 * to_seconds(options_.period);
  const double reach_m = options_.speed_max_mps * horizon_s + options_.obstacle_margin_m;

  const auto keep_off = [&](const Vec2& towards, double surface_gap_m, double coming_mps = 0.0) {
    if (surface_gap_m > reach_m + coming_mps * horizon_s) return;
    constraints_.push_back(
        {towards, (surface_gap_m - options_.obstacle_margin_m) / horizon_s - coming_mps});
  };
  for (const ConvexObstacle& obstacle : world_.convex_obstacles()) {
    const double way_m = obstacle.velocity_mps.norm() * horizon_s;
    if (obstacle.box.distance_m(position_m) - options_.radius_m > reach_m + way_m) continue;
    const SignedDistance sd = obstacle.signed_distance(position_m);
    keep_off(-sd.gradient, sd.distance_m - options_.radius_m,
             std::max(0.0, sd.gradient.dot(obstacle.velocity_mps)));
  }
  const Box& bounds = world_.bounds_m();
  keep_off({-1.0, 0.0}, position_m.x() - bounds.min_m.x() - options_.radius_m);
  keep_off({1.0, 0.0}, bounds.max_m.x() - position_m.x() - options_.radius_m);
  keep_off({0.0, -1.0}, position_m.y() - bounds.min_m.y() - options_.radius_m);
  keep_off({0.0, 1.0}, bounds.max_m.y() - position_m.y() - options_.radius_m);

  for (const Neighbour& n : neighbours) {
    const Vec2 offset = n.position_m - position_m;
    const double distance = offset.norm();
    // Robots believed to be in the same spot: part to opposite sides, told apart by nothing but
    // chance.
    const Vec2 towards = distance > 1e-9 ? Vec2(offset / distance) : Vec2(1.0, 0.0);
    const double gap = distance - options_.radius_m - n.radius_m;
    const double retreat = std::max(0.0, towards.dot(n.velocity_mps));
    const double bound = options_.gap_share * (gap - options_.neighbour_margin_m) / horizon_s +
                         options_.follow_share * retreat;
    if (bound < options_.speed_max_mps) constraints_.push_back({towards, bound});
  }

  if (auto u = nearest_velocity(wish_mps, constraints_, options_.speed_max_mps)) return *u;
  for (HalfPlane& c : constraints_) c.bound_mps = std::max(0.0, c.bound_mps);
  return nearest_velocity(wish_mps, constraints_, options_.speed_max_mps).value_or(Vec2::Zero());
}

}  // namespace swarm::agent
