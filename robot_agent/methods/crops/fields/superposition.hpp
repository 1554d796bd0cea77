// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "swarmflow/core/linalg.hpp"

namespace swarm::agent {

/// All fields together: the strongest has the most influence [CRoPS, superimposition].
///
///   PF = Σ_φ ‖PF_φ‖ PF_φ / Σ_φ ‖PF_φ‖
///
/// Zero when all are.
inline Vec2 superposition(std::span<const Vec2> fields) {
  Vec2 sum = Vec2::Zero();
  double strengths = 0.0;
  for (const Vec2& field : fields) {
    const double strength = field.norm();
    sum += strength * field;
    strengths += strength;
  }
  if (strengths < 1e-12) return Vec2::Zero();
  return sum / strengths;
}

}  // namespace swarm::agent
