// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "swarmflow/core/gaussian.hpp"

/// The Gaussians that make up a density at one time, and the climb to its local maxima.
namespace swarm::planner {

/// A Gaussian that carries robots at one time, ready to be evaluated.
class DensityPart {
 public:
  /// `smoothed_m2` is added to both variances.
  DensityPart(const Gaussian& g, double robots, double smoothed_m2 = 0.0);

  const Vec2& mean_m() const { return mean_m_; }

  /// Whether a climb that starts at x has to consider it: it contributes there, or at a position
  /// that one of the parts in between can lead to.
  bool is_in_sight(const Vec2& x) const {
    return std::abs(x.x() - mean_m_.x()) <= sight_m_.x() &&
           std::abs(x.y() - mean_m_.y()) <= sight_m_.y();
  }
  /// [robots/m²]; nothing where it is less than 1e-6 of the peak.
  double density_at(const Vec2& x) const {
    const double squared = mahalanobis_squared(x);
    return squared > kFarSquared ? 0.0 : peak_per_m2_ * std::exp(-0.5 * squared);
  }
  /// The same, however far.
  double full_density_at(const Vec2& x) const {
    return peak_per_m2_ * std::exp(-0.5 * mahalanobis_squared(x));
  }

 private:
  friend Vec2 climb(const std::vector<DensityPart>& parts, Vec2 x);
  // 1e-6 of the peak is left at this many standard deviations.
  static constexpr double kFar = 5.3;
  static constexpr double kFarSquared = kFar * kFar;

  double mahalanobis_squared(const Vec2& x) const {
    const Vec2 d = x - mean_m_;
    return xx_ * d.x() * d.x() + 2.0 * xy_ * d.x() * d.y() + yy_ * d.y() * d.y();
  }

  Vec2 mean_m_;
  Vec2 sight_m_;         // half the box beyond which it is out of sight
  double xx_, xy_, yy_;  // Σ⁻¹
  double peak_per_m2_;
};

/// Means where the density is below this share of the density of interest need no climb. The middle
/// of a square of equal Gaussians has 1.3 times the density of its corners at most.
inline constexpr double kWorthClimbing = 0.7;

/// Follows the mean shift x ← (Σ wₖΣₖ⁻¹)⁻¹ Σ wₖΣₖ⁻¹μₖ, wₖ the density of part k at x, which never
/// descends, to a local maximum.
Vec2 climb(const std::vector<DensityPart>& parts, Vec2 x);

}  // namespace swarm::planner
