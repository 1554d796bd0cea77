// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/gmm/wasserstein.hpp"

#include <algorithm>
#include <cmath>

namespace swarm {

double wasserstein2_squared(const Gaussian& a, const Gaussian& b) {
  const Mat2& sa = a.covariance_m2();
  const Mat2& sb = b.covariance_m2();
  // tr(Σ_aΣ_b), and tr √M = √(tr M + 2√det M) for any 2×2 matrix M with positive eigenvalues.
  const double trace_product =
      sa(0, 0) * sb(0, 0) + 2.0 * sa(0, 1) * sb(0, 1) + sa(1, 1) * sb(1, 1);
  const double root_trace =
      std::sqrt(trace_product + 2.0 * std::sqrt(a.determinant() * b.determinant()));
  const double spread = sa(0, 0) + sa(1, 1) + sb(0, 0) + sb(1, 1) - 2.0 * root_trace;
  return (a.mean_m() - b.mean_m()).squaredNorm() + std::max(0.0, spread);
}

double wasserstein2(const Gaussian& a, const Gaussian& b) {
  return std::sqrt(wasserstein2_squared(a, b));
}

Mat2 transport_map(const Gaussian& a, const Gaussian& b) {
  // Geometric mean of X = Σ_a⁻¹ and Y = Σ_b in 2-D: √(xy) / √det P · P with P = X/x + Y/y and
  // x = √det X, y = √det Y: scaled to determinant 1, the mean is the normalised sum.
  const double root_det_a = std::sqrt(a.determinant());
  const double root_det_b = std::sqrt(b.determinant());
  const Mat2& sa = a.covariance_m2();
  const Mat2& sb = b.covariance_m2();
  // Σ_a⁻¹/x is the adjugate of Σ_a over √det Σ_a: no division by the small determinant itself.
  Mat2 p;
  p(0, 0) = sa(1, 1) / root_det_a + sb(0, 0) / root_det_b;
  p(1, 1) = sa(0, 0) / root_det_a + sb(1, 1) / root_det_b;
  p(0, 1) = p(1, 0) = -sa(0, 1) / root_det_a + sb(0, 1) / root_det_b;
  const double det_p = p(0, 0) * p(1, 1) - p(0, 1) * p(1, 0);
  return std::sqrt(root_det_b / (root_det_a * det_p)) * p;
}

Geodesic::Geodesic(const Gaussian& a, const Gaussian& b)
    : a_(a), mean_step_m_(b.mean_m() - a.mean_m()), map_(transport_map(a, b)) {}

Gaussian Geodesic::at(double t) const {
  const Mat2 blend = (1.0 - t) * Mat2::Identity() + t * map_;
  return Gaussian::from_valid(a_.mean_m() + t * mean_step_m_, blend * a_.covariance_m2() * blend);
}

}  // namespace swarm
