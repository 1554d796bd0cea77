// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/linalg.hpp"

namespace swarm::agent {

/// A term of a robot's potential at a place, as gradient flows need it.
struct Potential {
  double energy_m2 = 0.0;
  Vec2 gradient_m = Vec2::Zero();
  /// Bounds its upward curvature around the place, so that the step bound of Th. 6.3 can be kept.
  double curvature = 0.0;

  Potential& operator+=(const Potential& other) {
    energy_m2 += other.energy_m2;
    gradient_m += other.gradient_m;
    curvature += other.curvature;
    return *this;
  }
};

}  // namespace swarm::agent
