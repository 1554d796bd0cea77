// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/time.hpp"
#include "swarmflow/core/gaussian.hpp"

namespace swarm::planner {

/// A local maximum of the density N χ(t)(x) of a plan's mixture.
struct DensityPeak {
  double per_m2 = 0.0;  ///< [robots/m²]
  MissionTime time{0};
  Vec2 at_m = Vec2::Zero();
};

}  // namespace swarm::planner
