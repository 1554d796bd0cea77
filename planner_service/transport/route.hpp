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

struct Route {
  std::size_t from = 0;  ///< start component
  std::size_t to = 0;    ///< goal component
  double mass = 0.0;     ///< λᵢⱼ
  Waypoints waypoints;
};

}  // namespace swarm::planner
