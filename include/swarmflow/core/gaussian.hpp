// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/linalg.hpp"
#include "swarmflow/core/result.hpp"

namespace swarm {

/// 99 % quantile of χ² with two degrees of freedom: the 99 % ellipse of a Gaussian is the set of
/// points with a squared Mahalanobis distance of at most this.
inline constexpr double kChiSquared2Dof99 = 9.210340371976184;

/// A Gaussian g = N(μ, Σ) on the plane [SwarmPRM, §II-C], world frame. Always valid: finite, Σ
/// symmetric positive definite. A value type without heap memory; all functions are O(1).
class Gaussian {
 public:
  static constexpr double kMinSigma_m = 1e-3;  ///< least standard deviation in any direction [m]
  static constexpr double kMaxSigma_m = 1e5;   ///< largest standard deviation in any direction [m]

  /// Standard normal: μ = 0, Σ = I.
  Gaussian() = default;

  /// Makes N(μ, Σ) from numbers that come from outside (files, messages, callers).
  /// \param mean_m μ [m]
  /// \param covariance_m2 Σ [m²]
  /// \return kBadInput if a number is not finite, Σ is not symmetric (relative 1e-9) or not
  ///   positive definite, or a standard deviation is outside [kMinSigma_m, kMaxSigma_m]
  static Result<Gaussian> make(const Vec2& mean_m, const Mat2& covariance_m2);

  /// From the sampler's five parameters [x, y, σ₁, σ₂, ρ]:
  ///
  ///   Σ = [σ₁², ρσ₁σ₂; ρσ₁σ₂, σ₂²]                                  [SwarmPRM, eq. 8]
  ///
  /// \pre mean finite, σ₁ and σ₂ within [kMinSigma_m, kMaxSigma_m], |ρ| < 1; asserted
  static Gaussian from_parameters(const Vec2& mean_m, double sigma1_m, double sigma2_m, double rho);

  /// For results of closed forms that keep validity (geodesics, projections): only symmetrises Σ,
  /// without the checks of make(). \pre Σ is positive definite, asserted
  static Gaussian from_valid(const Vec2& mean_m, const Mat2& covariance_m2);

  /// μ [m].
  const Vec2& mean_m() const { return mean_m_; }
  /// Σ, exactly symmetric [m²].
  const Mat2& covariance_m2() const { return covariance_m2_; }
  /// det Σ > 0 [m⁴].
  double determinant() const {
    return covariance_m2_(0, 0) * covariance_m2_(1, 1) -
           covariance_m2_(0, 1) * covariance_m2_(1, 0);
  }

  /// Smallest standard deviation over all directions: the root of Σ's smaller eigenvalue [m].
  double min_sigma_m() const;
  /// Largest standard deviation over all directions: the root of Σ's larger eigenvalue [m].
  double max_sigma_m() const;

  /// nᵀΣn, the variance in the direction of a unit vector n [m²].
  double variance_along_m2(const Vec2& unit) const {
    return covariance_m2_(0, 0) * unit.x() * unit.x() +
           2.0 * covariance_m2_(0, 1) * unit.x() * unit.y() +
           covariance_m2_(1, 1) * unit.y() * unit.y();
  }

  /// Squared Mahalanobis distance of a point, (p−μ)ᵀ Σ⁻¹ (p−μ), dimensionless.
  double mahalanobis_squared(const Vec2& point_m) const;

  /// Probability density at a point [1/m²].
  double density(const Vec2& point_m) const;

  /// Whether a point lies inside the 99 % ellipse: what counts as being in a goal component.
  bool contains_99(const Vec2& point_m) const {
    return mahalanobis_squared(point_m) <= kChiSquared2Dof99;
  }

 private:
  Gaussian(const Vec2& mean_m, const Mat2& covariance_m2)
      : mean_m_(mean_m), covariance_m2_(covariance_m2) {}

  Vec2 mean_m_ = Vec2::Zero();
  Mat2 covariance_m2_ = Mat2::Identity();
};

/// Lower-triangular L with LLᵀ = Σ [m]: x = μ + Lz with z ~ N(0, I) is a sample of N(μ, Σ).
/// \pre Σ is symmetric positive definite, as Gaussian::covariance_m2() is; not checked
Mat2 cholesky_lower(const Mat2& covariance_m2);

}  // namespace swarm
