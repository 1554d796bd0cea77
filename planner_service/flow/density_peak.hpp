// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarm_core/base/time.hpp"
#include "swarm_core/gmm/gaussian.hpp"

namespace swarm::planner {

/// A local maximum of the density N χ(t)(x) of a plan's mixture.
struct DensityPeak {
  double per_m2 = 0.0;  ///< [robots/m²]
  MissionTime time{0};
  Vec2 at_m = Vec2::Zero();
};

}  // namespace swarm::planner
