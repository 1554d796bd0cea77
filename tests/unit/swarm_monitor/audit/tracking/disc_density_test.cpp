// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/audit/tracking/disc_density.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace swarm::monitor {
namespace {

/// A disc that holds the most has two points on its rim, or holds all around one point.
std::size_t most_by_all_pairs(const std::vector<Vec2>& points, double radius_m) {
  std::size_t most = 0;
  const auto count = [&](const Vec2& centre) {
    std::size_t inside = 0;
    for (const Vec2& p : points) inside += (p - centre).norm() <= radius_m + 1e-9 ? 1 : 0;
    most = std::max(most, inside);
  };
  for (const Vec2& a : points) {
    count(a);
    for (const Vec2& b : points) {
      const double apart_m = (b - a).norm();
      if (apart_m <= 0.0 || apart_m > 2.0 * radius_m) continue;
      const Vec2 aside = Vec2(a.y() - b.y(), b.x() - a.x()) / apart_m *
                         std::sqrt(radius_m * radius_m - 0.25 * apart_m * apart_m);
      count(0.5 * (a + b) + aside);
      count(0.5 * (a + b) - aside);
    }
  }
  return most;
}

TEST(DiscDensity, FindsTheFullestDiscWhereverItIs) {
  Rng rng(11);
  for (int round = 0; round < 40; ++round) {
    std::vector<Vec2> points;
    const double size_m = std::array{3.0, 10.0, 40.0}[static_cast<std::size_t>(round % 3)];
    for (int i = 0; i < 60; ++i) {
      points.emplace_back(uniform(rng, -size_m, size_m), uniform(rng, -size_m, size_m));
    }

    EXPECT_EQ(most_in_a_disc(points, 2.0), most_by_all_pairs(points, 2.0)) << round;
  }
}

TEST(DiscDensity, CountsPointsAtTheSamePlaceAndNone) {
  EXPECT_EQ(most_in_a_disc({}, 2.0), 0U);
  const std::vector<Vec2> same(5, Vec2(3, 4));
  EXPECT_EQ(most_in_a_disc(same, 2.0), 5U);
  const std::vector<Vec2> apart{{0, 0}, {4.1, 0}};
  EXPECT_EQ(most_in_a_disc(apart, 2.0), 1U);
  const std::vector<Vec2> near{{0, 0}, {3.9, 0}};
  EXPECT_EQ(most_in_a_disc(near, 2.0), 2U);
  EXPECT_NEAR(peak_density_per_m2(near), 2.0 / (4.0 * std::numbers::pi), 1e-12);
}

TEST(DiscDensity, OfAGaussianIsTheClosedForm) {
  // 1 − exp(−R²/2σ²) of a round Gaussian lies within R of its mean. The header's 5 %.
  for (const double sigma_m : {1.0, 1.7, 3.0, 10.0}) {
    const auto mixture = Mixture::make(
        {{1.0, Gaussian::from_valid({12.3, 4.56}, sigma_m * sigma_m * Mat2::Identity())}});
    ASSERT_TRUE(mixture.has_value());
    const double within = 1.0 - std::exp(-2.0 / (sigma_m * sigma_m));
    const double expected = 500.0 * within / (4.0 * std::numbers::pi);

    const double planned = planned_peak_density_per_m2(*mixture, 500);

    EXPECT_NEAR(planned, expected, 0.05 * expected) << sigma_m;
  }
}

TEST(DiscDensity, OfOverlappingComponentsIsTheirSum) {
  const Gaussian gaussian = Gaussian::from_valid({5, 5}, 4.0 * Mat2::Identity());
  const auto one = Mixture::make({{1.0, gaussian}});
  const auto two = Mixture::make({{0.25, gaussian}, {0.75, gaussian}});
  ASSERT_TRUE(one && two);

  EXPECT_NEAR(planned_peak_density_per_m2(*one, 100), planned_peak_density_per_m2(*two, 100), 1e-9);
}

}  // namespace
}  // namespace swarm::monitor
