// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarm_core/gmm/gaussian.hpp"

namespace swarm::planner {

/// A route ξᵢⱼ: Gaussians joined by W₂ geodesics, from a start component to a goal component.
using Waypoints = std::vector<Gaussian>;

/// Σ W₂ over the legs [m]: the cost of a route.
double w2_length_m(const Waypoints& waypoints);

/// Σ |Δμ| over the legs [m]: the way of the mean.
double mean_length_m(const Waypoints& waypoints);

/// How long a leg takes when means move at `speed_mps` [s]. A mean that stands still while its
/// Gaussian changes shape still takes its robots along: the leg then lasts as long as their mean
/// way asks for. Never 0, legs must run forward in time even where nothing moves.
double leg_duration_s(const Gaussian& from, const Gaussian& to, double speed_mps);

struct Route {
  std::size_t from = 0;  ///< start component
  std::size_t to = 0;    ///< goal component
  double mass = 0.0;     ///< λᵢⱼ
  Waypoints waypoints;
};

}  // namespace swarm::planner
