// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "swarmflow/core/random.hpp"
#include "swarmflow/core/gaussian.hpp"

namespace swarm {

struct WeightedGaussian {
  double weight = 0.0;
  Gaussian gaussian;
};

/// A Gaussian mixture Σᵢ ωᵢ gᵢ; weights positive, summing to 1.
class Mixture {
 public:
  /// Accepts weights that sum to 1 within `kWeightTolerance` and normalises the rest away.
  static constexpr double kWeightTolerance = 1e-6;
  static Result<Mixture> make(std::vector<WeightedGaussian> components);

  const std::vector<WeightedGaussian>& components() const { return components_; }
  double density(const Vec2& point_m) const;

  /// Index of the component that owns the share u ∈ [0, 1) of the cumulated weights.
  std::size_t component_at(double u) const;

 private:
  std::vector<WeightedGaussian> components_;
};

}  // namespace swarm
