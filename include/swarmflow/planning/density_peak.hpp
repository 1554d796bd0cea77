// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/gaussian.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::planner {

/// A local maximum of the density N χ(t)(x) of a plan's mixture, N the number of robots.
struct DensityPeak {
  double per_m2 = 0.0;       ///< the density [robots/m²]
  MissionTime time{0};       ///< plan time of the maximum [s]
  Vec2 at_m = Vec2::Zero();  ///< its position [m]
};

}  // namespace swarm::planner
