// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "swarmflow/core/gaussian.hpp"

namespace swarm::planner {

/// A route ξᵢⱼ: Gaussians joined by W₂ geodesics, from a start component to a goal component.
using Waypoints = std::vector<Gaussian>;

/// Σ W₂ over the legs [m]: the cost of a route.
double w2_length_m(const Waypoints& waypoints);

/// Σ |Δμ| over the legs [m]: the path length of the mean.
double mean_length_m(const Waypoints& waypoints);

/// How long a leg takes when means move at `speed_mps` [s]. Robots also move where the mean is at
/// rest and only the shape changes: then the leg lasts as long as their root mean square path takes
/// at that speed. Never 0, legs must run forward in time even where nothing moves.
double leg_duration_s(const Gaussian& from, const Gaussian& to, double speed_mps);

/// How fast a plan moves.
struct LegSpeed {
  double means_mps = 1.25;  ///< of the means
  /// Speed that a leg from a start or to a goal may require of a robot of the 2σ ellipse.
  double robots_mps = std::numeric_limits<double>::infinity();
};

/// The longest path of a robot of the 2σ ellipse along a leg [m]:
///
///   max |Δμ + (T − I)y|  over  yᵀΣ⁻¹y ≤ 4,   T the transport map from Σ to the other end's shape.
///
/// An affine function of a point of the unit disc: by the dual of that problem, which has no gap, a
/// minimum over one number. Never below the exact value, above it by rounding. About 1 µs.
double longest_robot_path_m(const Gaussian& from, const Gaussian& to);

/// leg_duration_s() of a leg that leaves a start or enters a goal. Components are wide, and the
/// shape changes most there: where σ goes from 10 m to 2 m in 17 m, robots at the far side have
/// twice the path of the mean. So the leg also takes as long as robots of the 2σ ellipse need.
double end_leg_duration_s(const Gaussian& from, const Gaussian& to, const LegSpeed& speed);

/// Of the leg that ends at waypoint i ≥ 1: the first and the last one are ends.
double route_leg_duration_s(const Waypoints& waypoints, std::size_t i, const LegSpeed& speed);

/// A route with the share of the swarm that takes it.
struct Route {
  std::size_t from = 0;  ///< start component
  std::size_t to = 0;    ///< goal component
  double mass = 0.0;     ///< λᵢⱼ
  Waypoints waypoints;
};

}  // namespace swarm::planner
