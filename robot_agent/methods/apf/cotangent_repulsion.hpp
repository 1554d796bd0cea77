// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "robot_agent/methods/shared/potential.hpp"
#include "robot_agent/neighbours/neighbour_table.hpp"

namespace swarm::agent {

/// The repulsion's parameters.
struct CotangentOptions {
  double strength_m2 = 0.01;  ///< G₀
  double range_m = 1.0;       ///< R, from centre to centre
  /// The slope fades to 0 over this share of R below R; 0: exact, with a corner there. Robots at
  /// rest need it: at a corner, pairs oscillate for ever.
  double fade_share = 0.0;
};

/// Repulsion of a robot by its neighbours [intermittent diffusion, eq. 7 and section 5]:
///
///   G = G₀ Σⱼ cot θⱼ,   θ = πd²/(2R²) for d < R
///   ∂G/∂x = −G₀ Σⱼ csc²θⱼ (π/R²) (x − xⱼ)
///
/// with the exact derivative; the official code has cot·csc for csc². G is 0 at R, where its slope
/// jumps by G₀π/R, and ∞ at d = 0. `curvature` is 2 Σⱼ g''(dⱼ − 2s) with s = `reach_m`: a pair
/// bends the potential of both, and both may move by s. O(neighbours), a sine and a cosine for each
/// in range.
Potential cotangent_repulsion(const Vec2& position_m, std::span<const Neighbour> neighbours,
                              const CotangentOptions& options, double reach_m = 0.0);

}  // namespace swarm::agent
