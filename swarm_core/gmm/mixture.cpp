// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/mixture.hpp"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "swarm_core/base/assert.hpp"

namespace swarm {

// Weights within the tolerance are scaled to sum 1, so that later sums need no tolerance of their
// own.
Result<Mixture> Mixture::make(std::vector<WeightedGaussian> components) {
  if (components.empty()) return fail(ErrorCode::kBadInput, "mixture: needs a component");
  double sum = 0.0;
  for (std::size_t i = 0; i < components.size(); ++i) {
    const double weight = components[i].weight;
    if (!std::isfinite(weight) || weight <= 0.0) {
      return fail(ErrorCode::kBadInput,
                  fmt::format("mixture: weight {} of component {} must be positive", weight, i));
    }
    sum += weight;
  }
  if (std::abs(sum - 1.0) > kWeightTolerance) {
    return fail(ErrorCode::kBadInput, fmt::format("mixture: weights sum to {}, not to 1", sum));
  }
  for (WeightedGaussian& component : components) component.weight /= sum;
  Mixture mixture;
  mixture.components_ = std::move(components);
  return mixture;
}

double Mixture::density(const Vec2& point_m) const {
  double density = 0.0;
  for (const auto& [weight, gaussian] : components_) density += weight * gaussian.density(point_m);
  return density;
}

// Inverse of the cumulated weights. The last component also takes what rounding leaves above the
// sum.
std::size_t Mixture::component_at(double u) const {
  SWARM_ASSERT(!components_.empty());
  double cumulated = 0.0;
  for (std::size_t i = 0; i + 1 < components_.size(); ++i) {
    cumulated += components_[i].weight;
    if (u < cumulated) return i;
  }
  return components_.size() - 1;
}

}  // namespace swarm
