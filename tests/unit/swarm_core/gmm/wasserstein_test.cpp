// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/gmm/wasserstein.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/unit/swarm_core/gmm/random_gaussian.hpp"

namespace swarm {
namespace {

Mat2 root(const Mat2& m) { return Eigen::SelfAdjointEigenSolver<Mat2>(m).operatorSqrt(); }

Mat2 inverse_root(const Mat2& m) {
  return Eigen::SelfAdjointEigenSolver<Mat2>(m).operatorInverseSqrt();
}

// SwarmPRM eq. 2 as it is printed.
double printed_w2_squared(const Gaussian& a, const Gaussian& b) {
  const Mat2 root_a = root(a.covariance_m2());
  const Mat2 cross = root(root_a * b.covariance_m2() * root_a);
  return (a.mean_m() - b.mean_m()).squaredNorm() +
         (a.covariance_m2() + b.covariance_m2() - 2.0 * cross).trace();
}

// SwarmPRM eq. 4 as it is printed.
Mat2 printed_covariance(const Gaussian& a, const Gaussian& b, double t) {
  const Mat2 root_a = root(a.covariance_m2());
  const Mat2 inverse = inverse_root(a.covariance_m2());
  const Mat2 inner = (1.0 - t) * a.covariance_m2() + t * root(root_a * b.covariance_m2() * root_a);
  return inverse * inner * inner * inverse;
}

// Covariances up to 400 m² and condition numbers up to 1e5; entries agree to rounding times both.
constexpr double kTolerance = 1e-8;

TEST(Wasserstein, MatchesTheMatrixRootsOfThePaper) {
  Rng rng(3);
  for (int i = 0; i < 500; ++i) {
    const Gaussian a = test::random_gaussian(rng);
    const Gaussian b = test::random_gaussian(rng);

    EXPECT_NEAR(wasserstein2_squared(a, b), printed_w2_squared(a, b), kTolerance);
    EXPECT_DOUBLE_EQ(wasserstein2(a, b), std::sqrt(wasserstein2_squared(a, b)));
  }
}

TEST(Wasserstein, IsAMetric) {
  Rng rng(4);
  for (int i = 0; i < 500; ++i) {
    const Gaussian a = test::random_gaussian(rng);
    const Gaussian b = test::random_gaussian(rng);
    const Gaussian c = test::random_gaussian(rng);

    EXPECT_DOUBLE_EQ(wasserstein2(a, b), wasserstein2(b, a));
    EXPECT_LE(wasserstein2(a, c), wasserstein2(a, b) + wasserstein2(b, c) + kTolerance);
    // The root of a difference that cancels: √(400 m² · 2⁻⁵²) is 3e-7 m.
    EXPECT_NEAR(wasserstein2(a, a), 0.0, 2e-6);
  }
}

TEST(Wasserstein, IsTheDistanceOfTheMeansForEqualShapes) {
  const Gaussian a = Gaussian::from_parameters({0, 0}, 2.0, 3.0, 0.4);
  const Gaussian b = Gaussian::from_parameters({3, 4}, 2.0, 3.0, 0.4);

  EXPECT_NEAR(wasserstein2(a, b), 5.0, 1e-12);
}

TEST(TransportMap, IsSymmetricAndCarriesOneCovarianceIntoTheOther) {
  Rng rng(5);
  for (int i = 0; i < 500; ++i) {
    const Gaussian a = test::random_gaussian(rng);
    const Gaussian b = test::random_gaussian(rng);

    const Mat2 map = transport_map(a, b);

    EXPECT_EQ(map(0, 1), map(1, 0));
    EXPECT_GT(map(0, 0), 0.0);
    EXPECT_GT(map.determinant(), 0.0);
    EXPECT_NEAR((map * a.covariance_m2() * map - b.covariance_m2()).norm(), 0.0, kTolerance);
  }
}

TEST(TransportMap, CostsExactlyTheDistance) {
  Rng rng(6);
  for (int i = 0; i < 200; ++i) {
    const Gaussian a = test::random_gaussian(rng);
    const Gaussian b = test::random_gaussian(rng);
    const Mat2 move = transport_map(a, b) - Mat2::Identity();

    // E‖T(x−μ) − (x−μ)‖² = tr((T−I)Σ(T−I)): the mean squared path of the robots.
    const double mean_squared_path =
        (b.mean_m() - a.mean_m()).squaredNorm() + (move * a.covariance_m2() * move).trace();

    EXPECT_NEAR(wasserstein2_squared(a, b), mean_squared_path, kTolerance);
  }
}

TEST(Geodesic, MatchesTheMatrixRootsOfThePaper) {
  Rng rng(7);
  for (int i = 0; i < 200; ++i) {
    const Gaussian a = test::random_gaussian(rng);
    const Gaussian b = test::random_gaussian(rng);
    const Geodesic geodesic(a, b);
    for (const double t : {0.0, 0.1, 0.5, 0.77, 1.0}) {
      const Gaussian g = geodesic.at(t);

      EXPECT_NEAR((g.mean_m() - ((1.0 - t) * a.mean_m() + t * b.mean_m())).norm(), 0.0, 1e-12);
      EXPECT_NEAR((g.covariance_m2() - printed_covariance(a, b, t)).norm(), 0.0, kTolerance);
    }
  }
}

TEST(Geodesic, RunsAtConstantSpeed) {
  Rng rng(8);
  for (int i = 0; i < 100; ++i) {
    const Gaussian a = test::random_gaussian(rng);
    const Gaussian b = test::random_gaussian(rng);
    const Geodesic geodesic(a, b);

    const double whole = wasserstein2(a, b);

    EXPECT_NEAR(wasserstein2(geodesic.at(0.2), geodesic.at(0.7)), 0.5 * whole, 1e-6);
    EXPECT_NEAR(wasserstein2(a, geodesic.at(0.3)), 0.3 * whole, 1e-6);
  }
}

/// σ of 1000 m and 1 cm, the long axis at this angle.
Gaussian needle(const Vec2& mean_m, double angle) {
  const Mat2 turn = Eigen::Rotation2Dd(angle).toRotationMatrix();
  const Mat2 covariance_m2 = turn * Vec2(1e6, 1e-4).asDiagonal() * turn.transpose();
  return Gaussian::make(mean_m, 0.5 * (covariance_m2 + covariance_m2.transpose())).value();
}

// The most that the gate lets through: axes that differ by 10⁵.
TEST(Geodesic, LeadsFromOneNeedleToACrossingOne) {
  Rng rng(12);
  for (int i = 0; i < 1000; ++i) {
    const Geodesic geodesic(needle({0, 0}, uniform(rng, 0, 3.14)),
                            needle({30, 0}, uniform(rng, 0, 3.14)));
    for (const double t : {0.0, 0.3, 1.0}) {
      EXPECT_GT(geodesic.at(t).covariance_m2().determinant(), 0.0) << i << ' ' << t;
    }
  }
}

}  // namespace
}  // namespace swarm
