// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/safety/half_plane_qp.hpp"

#include <algorithm>
#include <cmath>

namespace swarm::agent {
namespace {

// Tolerance for rounding, far below any speed that matters.
constexpr double kSlack_mps = 1e-9;

/// The point of the line n·u = b nearest to `desired_velocity` that the disc and the earlier
/// half-planes allow.
std::optional<Vec2> nearest_on_line(const Vec2& desired_velocity,
                                    std::span<const HalfPlane> earlier, const HalfPlane& line,
                                    double speed_max) {
  const double half_chord_squared = speed_max * speed_max - line.bound_mps * line.bound_mps;
  if (half_chord_squared < 0.0) return std::nullopt;  // the line misses the disc
  // The line is foot + t along; disc and half-planes bound t to [low, high].
  const Vec2 foot = line.bound_mps * line.normal;
  const Vec2 along(-line.normal.y(), line.normal.x());
  double high = std::sqrt(half_chord_squared);
  double low = -high;
  for (const HalfPlane& other : earlier) {
    const double slope = other.normal.dot(along);
    const double room = other.bound_mps - other.normal.dot(foot);
    // Parallel lines: the other half-plane contains all of this line or nothing of it.
    if (std::abs(slope) < 1e-12) {
      if (room < -kSlack_mps) return std::nullopt;
      continue;
    }
    const double limit = room / slope;
    if (slope > 0.0) {
      high = std::min(high, limit);
    } else {
      low = std::max(low, limit);
    }
    if (low > high + kSlack_mps) return std::nullopt;
  }
  const double desired = along.dot(desired_velocity - foot);
  return foot + std::clamp(desired, low, std::max(low, high)) * along;
}

}  // namespace

/// Seidel: adds one half-plane at a time. While the optimum so far lies within it, nothing changes;
/// otherwise the new optimum lies on its line, a problem in one dimension.
[[gnu::hot]] std::optional<Vec2> nearest_velocity(const Vec2& desired_mps,
                                                  std::span<const HalfPlane> constraints,
                                                  double speed_max_mps) {
  const double desired = desired_mps.norm();
  Vec2 best = desired > speed_max_mps ? Vec2(desired_mps * (speed_max_mps / desired)) : desired_mps;
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const HalfPlane& c = constraints[i];
    if (c.normal.dot(best) <= c.bound_mps + kSlack_mps) continue;
    const std::optional<Vec2> moved =
        nearest_on_line(desired_mps, constraints.first(i), c, speed_max_mps);
    if (!moved) return std::nullopt;
    best = *moved;
  }
  return best;
}

}  // namespace swarm::agent
