// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/gaussian.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/unit/swarm_core/gmm/random_gaussian.hpp"

namespace swarm {
namespace {

Mat2 matrix(double xx, double xy, double yx, double yy) {
  Mat2 m;
  m << xx, xy, yx, yy;
  return m;
}

TEST(Gaussian, RefusesWhatIsNoCovariance) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();

  EXPECT_FALSE(Gaussian::make({nan, 0}, Mat2::Identity()).has_value());
  EXPECT_FALSE(Gaussian::make({0, inf}, Mat2::Identity()).has_value());
  EXPECT_FALSE(Gaussian::make({0, 0}, matrix(nan, 0, 0, 1)).has_value());
  EXPECT_FALSE(Gaussian::make({0, 0}, matrix(1, nan, nan, 1)).has_value());
  EXPECT_FALSE(Gaussian::make({0, 0}, matrix(1, 0.1, 0.2, 1)).has_value());  // not symmetric
  EXPECT_FALSE(Gaussian::make({0, 0}, matrix(1, 2, 2, 1)).has_value());      // indefinite
  EXPECT_FALSE(Gaussian::make({0, 0}, matrix(1, 1, 1, 1)).has_value());      // singular
  EXPECT_FALSE(Gaussian::make({0, 0}, matrix(-1, 0, 0, -1)).has_value());    // det > 0, negative
  EXPECT_FALSE(Gaussian::make({0, 0}, matrix(0, 0, 0, 0)).has_value());
  EXPECT_FALSE(Gaussian::make({0, 0}, matrix(1e-7, 0, 0, 1)).has_value());  // too narrow
  EXPECT_FALSE(Gaussian::make({0, 0}, matrix(1e11, 0, 0, 1)).has_value());  // too wide
  EXPECT_FALSE(Gaussian::make({0, 0}, matrix(1e300, 0, 0, 1e300)).has_value());
}

TEST(Gaussian, AcceptsItsOwnLimits) {
  const double low = Gaussian::kMinSigma_m;
  const double high = Gaussian::kMaxSigma_m;

  const auto g = Gaussian::make({1, 2}, matrix(low * low, 0, 0, high * high));

  ASSERT_TRUE(g.has_value()) << g.error().message;
  EXPECT_NEAR(g->min_sigma_m(), low, 1e-12);
  EXPECT_NEAR(g->max_sigma_m(), high, 1e-4);
}

TEST(Gaussian, NamesTheOffendingCovariance) {
  const auto g = Gaussian::make({0, 0}, matrix(1, 2, 2, 1));

  ASSERT_FALSE(g.has_value());
  EXPECT_EQ(g.error().code, ErrorCode::kBadInput);
  EXPECT_NE(g.error().message.find("positive definite"), std::string::npos);
}

TEST(Gaussian, AgreesWithGeneralLinearAlgebra) {
  Rng rng(1);
  for (int i = 0; i < 200; ++i) {
    const Gaussian g = test::random_gaussian(rng);
    const Mat2& s = g.covariance_m2();
    const Eigen::SelfAdjointEigenSolver<Mat2> eigen(s);
    const Vec2 p(uniform(rng, -120.0, 120.0), uniform(rng, -120.0, 120.0));
    const Vec2 d = p - g.mean_m();
    const double angle = uniform(rng, 0.0, 2.0 * std::numbers::pi);
    const Vec2 unit(std::cos(angle), std::sin(angle));
    const double mahalanobis = d.dot(s.inverse() * d);

    // |ρ| ≤ 0.95 keeps the condition number below 1e5: 1e-9 is rounding times that.
    EXPECT_NEAR(g.min_sigma_m(), std::sqrt(eigen.eigenvalues()(0)), 1e-9);
    EXPECT_NEAR(g.max_sigma_m(), std::sqrt(eigen.eigenvalues()(1)), 1e-9);
    EXPECT_NEAR(g.variance_along_m2(unit), unit.dot(s * unit), 1e-9);
    EXPECT_NEAR(g.mahalanobis_squared(p), mahalanobis, 1e-9 * (1.0 + mahalanobis));
    EXPECT_NEAR((cholesky_lower(s) * cholesky_lower(s).transpose() - s).norm(), 0.0, 1e-9);
  }
}

TEST(Gaussian, DensityIntegratesToOne) {
  const Gaussian g = Gaussian::from_parameters({3, -2}, 2.0, 0.7, -0.6);
  double mass = 0.0;
  const double step = 0.05;

  for (double x = -17.0; x < 23.0; x += step) {
    for (double y = -10.0; y < 6.0; y += step) mass += g.density({x, y}) * step * step;
  }

  EXPECT_NEAR(mass, 1.0, 1e-9);  // the midpoint rule converges geometrically for a Gaussian
}

TEST(Gaussian, EllipseHolds99PercentOfItsSamples) {
  Rng rng(2);
  const Gaussian g = Gaussian::from_parameters({3, -2}, 2.0, 0.7, 0.9);
  const Mat2 lower = cholesky_lower(g.covariance_m2());
  const int samples = 100'000;
  int inside = 0;

  for (int i = 0; i < samples; ++i) {
    const double z1 = standard_normal(rng);
    const double z2 = standard_normal(rng);
    inside += g.contains_99(g.mean_m() + lower * Vec2(z1, z2)) ? 1 : 0;
  }

  EXPECT_NEAR(inside, 0.99 * samples, 150.0);  // σ = √(n·0.99·0.01) = 31.5
}

}  // namespace
}  // namespace swarm
