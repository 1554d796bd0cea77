// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "swarmflow/core/mixture.hpp"
#include "swarmflow/core/random.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm {

/// A piece of a shape: its weight, its centre, and its own extent as a covariance (p²/12 · I for a
/// square of side p; zero for a point).
struct Patch {
  double weight = 0.0;  ///< ≥ 0, in any unit
  Vec2 center_m = Vec2::Zero();
  Mat2 spread_m2 = Mat2::Zero();
};

/// How to fit a mixture; kBadInput from fit_mixture() if a number is out of its range.
struct FitOptions {
  std::uint32_t components = 0;       ///< 0: the number of least BIC, up to components_max
  std::uint32_t components_max = 16;  ///< bound of that search
  double sigma_min_m = 0.5;           ///< no standard deviation of the mixture is smaller
  double weight_min = 1e-3;           ///< components lighter than this are left out
  std::uint32_t starts = 3;  ///< k-means++ starts; the best after 10 iterations is continued
  std::uint32_t iterations_max = 200;  ///< EM iterations of the fit that is continued
  double tolerance = 1e-5;  ///< converged when an iteration gains less [nats per unit weight]
};

/// A fitted mixture and the course of the fit.
struct MixtureFit {
  Mixture mixture;
  /// F after each iteration of the climb that gave the mixture; never falls.
  std::vector<double> mean_log_likelihood;
};

/// Fits a Gaussian mixture to a shape by expectation–maximisation, which increases
///
///   F = Σᵢ vᵢ ln Σⱼ ωⱼ exp E[ln gⱼ(X)],   X ~ patch i, vᵢ its share of the weight
///   E[ln gⱼ(X)] = ln gⱼ(cᵢ) − ½ tr(Σⱼ⁻¹ Sᵢ),   cᵢ and Sᵢ its centre and spread
///
/// the log-likelihood where patches are points. A patch's extent enters the covariances in full, so
/// a stroke one pixel wide is as wide as a pixel. Covariances are limited from below by raising
/// their small eigenvalues to σ_min², which is the exact maximiser under that limit: F never falls.
///
/// The number of components asked for is an upper bound: there are no more than distinct patches.
/// BIC = −2nF + (6K − 1) ln n with n = (Σv)²/Σv²; its search ends after three K without gain.
/// Deterministic for a given generator state. O(iterations · patches · components).
///
/// kBadInput: no patch with weight, a number that is not finite, negative weight, or options out of
/// range.
Result<MixtureFit> fit_mixture(std::span<const Patch> patches, const FitOptions& options, Rng& rng);

}  // namespace swarm
