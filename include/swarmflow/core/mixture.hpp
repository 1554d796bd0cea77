// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarmflow/core/gaussian.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm {

/// One component of a mixture, ω g.
struct WeightedGaussian {
  double weight = 0.0;  ///< ω: share of the mass, in (0, 1] within a Mixture
  Gaussian gaussian;    ///< g, world frame
};

/// A Gaussian mixture ϱ = Σᵢ ωᵢ gᵢ [SwarmPRM, §II-C]: the macroscopic state of a swarm. Weights are
/// positive and sum to 1. Immutable once made, apart from assignment.
class Mixture {
 public:
  /// Largest deviation of the sum of weights from 1 that make() accepts.
  static constexpr double kWeightTolerance = 1e-6;

  /// Makes a mixture of at least one component; weights are divided by their sum.
  /// \return kBadInput if there is no component, a weight is not finite and positive, or the
  ///   weights do not sum to 1 within kWeightTolerance
  static Result<Mixture> make(std::vector<WeightedGaussian> components);

  /// The components, in the order given to make(); empty only for a default-constructed mixture.
  const std::vector<WeightedGaussian>& components() const { return components_; }

  /// Probability density ϱ(p) at a point [1/m²]; N times it is the density of N robots.
  /// O(components).
  double density(const Vec2& point_m) const;

  /// Index i of the component with Σ_{j<i} ωⱼ ≤ u < Σ_{j≤i} ωⱼ: draws a component from a uniform u
  /// ∈ [0, 1). A u ≥ 1 gives the last one. O(components). \pre some components, asserted
  std::size_t component_at(double u) const;

 private:
  std::vector<WeightedGaussian> components_;
};

}  // namespace swarm
