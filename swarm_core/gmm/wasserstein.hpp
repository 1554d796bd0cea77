// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/gaussian.hpp"

namespace swarm {

/// Squared 2-Wasserstein distance between two Gaussians [m²].
///
///   W₂² = ‖μ₁−μ₂‖² + tr(Σ₁ + Σ₂ − 2(Σ₁^½ Σ₂ Σ₁^½)^½)                        [SwarmPRM, eq. 2]
///
/// In 2-D the root's trace is √(tr(Σ₁Σ₂) + 2√(det Σ₁ det Σ₂)); no eigen-decomposition. Never
/// negative: rounding below 0 is clamped.
double wasserstein2_squared(const Gaussian& a, const Gaussian& b);
/// The distance itself [m].
double wasserstein2(const Gaussian& a, const Gaussian& b);

/// Matrix T of the optimal transport map x ↦ μ_b + T(x − μ_a): the geometric mean Σ_a⁻¹ # Σ_b.
/// Symmetric positive definite, TΣ_aT = Σ_b. A robot at μ_a + y rides to μ_b + Ty in a straight
/// line.
Mat2 transport_map(const Gaussian& a, const Gaussian& b);

/// Point t ∈ [0, 1] of the W₂ geodesic from a to b                     [SwarmPRM, eq. 3 and 4].
///
///   μ(t) = (1−t)μ_a + tμ_b,   Σ(t) = AΣ_aA  with  A = (1−t)I + tT    (the same as eq. 4, no roots)
class Geodesic {
 public:
  /// Computes the transport map from a to b once; at() is then cheap.
  Geodesic(const Gaussian& a, const Gaussian& b);
  /// The Gaussian at t; t outside [0, 1] is not meaningful.
  Gaussian at(double t) const;

 private:
  Gaussian a_;
  Vec2 mean_step_m_;
  Mat2 map_;
};

}  // namespace swarm
