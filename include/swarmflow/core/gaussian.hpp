// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm {

/// 99 % quantile of χ² with two degrees of freedom: a Gaussian's 99 % ellipse is where the squared
/// Mahalanobis distance is at most this.
inline constexpr double kChiSquared2Dof99 = 9.210340371976184;

/// A Gaussian g = N(μ, Σ) on the plane; always valid: finite, Σ symmetric positive definite.
class Gaussian {
 public:
  /// Smallest and largest standard deviation accepted along any axis [m].
  static constexpr double kMinSigma_m = 1e-3;
  static constexpr double kMaxSigma_m = 1e5;

  /// Standard normal: μ = 0, Σ = I.
  Gaussian() = default;

  /// Checks that all numbers are finite, that Σ is symmetric (relative 1e-9) and that its standard
  /// deviations lie within [kMinSigma_m, kMaxSigma_m].
  static Result<Gaussian> make(const Vec2& mean_m, const Mat2& covariance_m2);

  /// From the sampler's 5-D parameter vector [x, y, σ₁, σ₂, ρ]                     [SwarmPRM, eq.
  /// 8]. \pre σ₁, σ₂ within the limits above, |ρ| < 1; asserted.
  static Gaussian from_parameters(const Vec2& mean_m, double sigma1_m, double sigma2_m, double rho);

  /// For results of closed forms that keep validity (geodesics, projections); asserts det > 0.
  static Gaussian from_valid(const Vec2& mean_m, const Mat2& covariance_m2);

  const Vec2& mean_m() const { return mean_m_; }
  const Mat2& covariance_m2() const { return covariance_m2_; }
  double determinant() const {
    return covariance_m2_(0, 0) * covariance_m2_(1, 1) -
           covariance_m2_(0, 1) * covariance_m2_(1, 0);
  }

  /// Smallest and largest standard deviation over all directions [m].
  double min_sigma_m() const;
  double max_sigma_m() const;

  /// nᵀΣn for a unit vector n [m²].
  double variance_along_m2(const Vec2& unit) const {
    return covariance_m2_(0, 0) * unit.x() * unit.x() +
           2.0 * covariance_m2_(0, 1) * unit.x() * unit.y() +
           covariance_m2_(1, 1) * unit.y() * unit.y();
  }

  /// (p−μ)ᵀ Σ⁻¹ (p−μ).
  double mahalanobis_squared(const Vec2& point_m) const;

  /// Probability density at a point [1/m²].
  double density(const Vec2& point_m) const;

  bool contains_99(const Vec2& point_m) const {
    return mahalanobis_squared(point_m) <= kChiSquared2Dof99;
  }

 private:
  Gaussian(const Vec2& mean_m, const Mat2& covariance_m2)
      : mean_m_(mean_m), covariance_m2_(covariance_m2) {}

  Vec2 mean_m_ = Vec2::Zero();
  Mat2 covariance_m2_ = Mat2::Identity();
};

/// Lower-triangular L with LLᵀ = Σ: x = μ + Lz with z ~ N(0, I) is a sample.
Mat2 cholesky_lower(const Mat2& covariance_m2);

}  // namespace swarm
