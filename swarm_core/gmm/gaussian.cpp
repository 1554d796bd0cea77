// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/gaussian.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "swarm_core/base/assert.hpp"

namespace swarm {
namespace {

// Largest difference of the off-diagonal entries, relative to the larger variance.
constexpr double kSymmetryTolerance = 1e-9;
// Lets a covariance that sits exactly on a limit survive its own rounding.
constexpr double kLimitSlack = 1.0 + 1e-9;

// The larger eigenvalue of a symmetric 2×2 matrix: half the trace plus the radius of Mohr's circle.
double max_variance_m2(const Mat2& s) {
  const double half_difference = 0.5 * (s(0, 0) - s(1, 1));
  return 0.5 * (s(0, 0) + s(1, 1)) +
         std::sqrt(half_difference * half_difference + s(0, 1) * s(0, 1));
}

}  // namespace

// The checked constructor for input. Bounds on both standard deviations keep every later division
// and square root well-conditioned.
Result<Gaussian> Gaussian::make(const Vec2& mean_m, const Mat2& covariance_m2) {
  if (!mean_m.allFinite() || !covariance_m2.allFinite()) {
    return fail(ErrorCode::kBadInput, "Gaussian: mean and covariance must be finite numbers");
  }
  const double xy = covariance_m2(0, 1);
  const double yx = covariance_m2(1, 0);
  const double scale = std::max(std::abs(covariance_m2(0, 0)), std::abs(covariance_m2(1, 1)));
  if (std::abs(xy - yx) > kSymmetryTolerance * scale) {
    return fail(
        ErrorCode::kBadInput,
        fmt::format("Gaussian: covariance must be symmetric, got {} and {} off its diagonal", xy,
                    yx));
  }
  Mat2 symmetric = covariance_m2;
  symmetric(0, 1) = symmetric(1, 0) = 0.5 * (xy + yx);
  const Gaussian g(mean_m, symmetric);
  // The largest variance is positive whenever the smallest is, so the quotient is safe to form.
  const bool positive = symmetric(0, 0) > 0.0 && symmetric(1, 1) > 0.0 && g.determinant() > 0.0;
  if (!positive || g.min_sigma_m() * kLimitSlack < kMinSigma_m ||
      g.max_sigma_m() > kMaxSigma_m * kLimitSlack) {
    return fail(
        ErrorCode::kBadInput,
        fmt::format("Gaussian: covariance [[{}, {}], [{}, {}]] must be positive definite with "
                    "standard deviations from {} to {} m",
                    symmetric(0, 0), symmetric(0, 1), symmetric(1, 0), symmetric(1, 1), kMinSigma_m,
                    kMaxSigma_m));
  }
  return g;
}

// [SwarmPRM, eq. 8]: Σ = [[σ₁², ρσ₁σ₂], [ρσ₁σ₂, σ₂²]].
Gaussian Gaussian::from_parameters(const Vec2& mean_m, double sigma1_m, double sigma2_m,
                                   double rho) {
  SWARM_ASSERT(mean_m.allFinite());
  SWARM_ASSERT(sigma1_m >= kMinSigma_m && sigma1_m <= kMaxSigma_m);
  SWARM_ASSERT(sigma2_m >= kMinSigma_m && sigma2_m <= kMaxSigma_m);
  SWARM_ASSERT(std::abs(rho) < 1.0);
  const double xy = rho * sigma1_m * sigma2_m;
  Mat2 covariance;
  covariance << sigma1_m * sigma1_m, xy, xy, sigma2_m * sigma2_m;
  return from_valid(mean_m, covariance);
}

// For covariances that are positive definite by construction, such as those on a W₂ geodesic: the
// cheap part of make() without its error messages.
Gaussian Gaussian::from_valid(const Vec2& mean_m, const Mat2& covariance_m2) {
  Gaussian g(mean_m, covariance_m2);
  // Rounding of a product like AΣA may leave the last bit of the two off-diagonals different.
  g.covariance_m2_(0, 1) = g.covariance_m2_(1, 0) =
      0.5 * (covariance_m2(0, 1) + covariance_m2(1, 0));
  SWARM_ASSERT(g.covariance_m2_(0, 0) > 0.0 && g.determinant() > 0.0);
  return g;
}

double Gaussian::min_sigma_m() const {
  // det/λ_max instead of the difference of two nearly equal numbers.
  return std::sqrt(determinant() / max_variance_m2(covariance_m2_));
}

double Gaussian::max_sigma_m() const { return std::sqrt(max_variance_m2(covariance_m2_)); }

// d'Σ⁻¹d with the inverse written out as adjugate over determinant.
[[gnu::hot]] double Gaussian::mahalanobis_squared(const Vec2& point_m) const {
  const Vec2 d = point_m - mean_m_;
  return (covariance_m2_(1, 1) * d.x() * d.x() - 2.0 * covariance_m2_(0, 1) * d.x() * d.y() +
          covariance_m2_(0, 0) * d.y() * d.y()) /
         determinant();
}

double Gaussian::density(const Vec2& point_m) const {
  return std::exp(-0.5 * mahalanobis_squared(point_m)) /
         (2.0 * std::numbers::pi * std::sqrt(determinant()));
}

// LL' = Σ; maps standard normal vectors to samples of the Gaussian.
Mat2 cholesky_lower(const Mat2& covariance_m2) {
  Mat2 lower = Mat2::Zero();
  lower(0, 0) = std::sqrt(covariance_m2(0, 0));
  lower(1, 0) = covariance_m2(1, 0) / lower(0, 0);
  lower(1, 1) = std::sqrt(
      (covariance_m2(0, 0) * covariance_m2(1, 1) - covariance_m2(0, 1) * covariance_m2(1, 0)) /
      covariance_m2(0, 0));
  return lower;
}

}  // namespace swarm
