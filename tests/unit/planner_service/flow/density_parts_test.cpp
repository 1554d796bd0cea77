// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/density_parts.hpp"

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm::planner {
namespace {

Gaussian random_gaussian(Rng& rng) {
  return Gaussian::from_parameters({uniform(rng, 0, 10), uniform(rng, 0, 10)},
                                   uniform(rng, 0.4, 3.0), uniform(rng, 0.4, 3.0),
                                   uniform(rng, -0.9, 0.9));
}

double density(const std::vector<DensityPart>& parts, const Vec2& x) {
  double sum = 0.0;
  for (const DensityPart& part : parts) sum += part.density_at(x);
  return sum;
}

TEST(DensityPart, IsTheGaussianTimesItsRobotsWhereThatMatters) {
  Rng rng(1);
  for (int i = 0; i < 100; ++i) {
    const Gaussian g = random_gaussian(rng);
    const DensityPart part(g, 30.0);
    const double peak_per_m2 = 30.0 * g.density(g.mean_m());
    for (int k = 0; k < 50; ++k) {
      const Vec2 x = g.mean_m() + Vec2(uniform(rng, -20, 20), uniform(rng, -20, 20));
      const double expected = 30.0 * g.density(x);

      EXPECT_NEAR(part.full_density_at(x), expected, 1e-12 * peak_per_m2);
      if (expected >= 1e-6 * peak_per_m2) {
        EXPECT_EQ(part.density_at(x), part.full_density_at(x));
      } else {
        EXPECT_LT(part.density_at(x), 1e-6 * peak_per_m2);
      }
    }
    EXPECT_EQ(part.density_at(g.mean_m() + Vec2(100, 0)), 0.0);
  }
}

TEST(DensityPart, SmoothingAddsToBothVariances) {
  Rng rng(2);
  const Gaussian g = random_gaussian(rng);
  const Gaussian smoothed =
      Gaussian::make(g.mean_m(), g.covariance_m2() + 1.7 * Mat2::Identity()).value();
  const DensityPart part(g, 5.0, 1.7);
  for (int k = 0; k < 50; ++k) {
    const Vec2 x(uniform(rng, 0, 10), uniform(rng, 0, 10));
    EXPECT_NEAR(part.full_density_at(x), 5.0 * smoothed.density(x), 1e-12);
  }
}

TEST(DensityPart, IsInSightWhereverItContributes) {
  Rng rng(3);
  int contributing = 0;
  int out_of_sight = 0;
  for (int i = 0; i < 2000; ++i) {
    const DensityPart part(random_gaussian(rng), 1.0);
    const Vec2 x(uniform(rng, -20, 30), uniform(rng, -20, 30));
    if (part.density_at(x) > 0.0) {
      ++contributing;
      EXPECT_TRUE(part.is_in_sight(x));
    }
    if (!part.is_in_sight(x)) ++out_of_sight;
  }
  EXPECT_GT(contributing, 100);
  EXPECT_GT(out_of_sight, 100) << "or the box would not spare anything";
}

TEST(Climb, NeverDescendsAndEndsAtALocalMaximum) {
  Rng rng(4);
  for (int i = 0; i < 200; ++i) {
    std::vector<DensityPart> parts;
    for (int p = 0; p < 6; ++p) parts.emplace_back(random_gaussian(rng), uniform(rng, 1, 20));
    const Vec2 from(uniform(rng, 0, 10), uniform(rng, 0, 10));

    const Vec2 top = climb(parts, from);

    const double highest = density(parts, top);
    // A part counts for nothing where it is below 1e-6 of its peak: that much may appear or vanish.
    EXPECT_GE(highest, density(parts, from) * (1.0 - 1e-5));
    // It is flat around the top: within 5 cm nothing is noticeably higher. Forty steps along a flat
    // ridge may stop before its end.
    for (int direction = 0; direction < 16; ++direction) {
      const double angle = 2.0 * std::numbers::pi * direction / 16.0;
      const Vec2 beside = top + 0.05 * Vec2(std::cos(angle), std::sin(angle));
      EXPECT_LE(density(parts, beside), highest * 1.01) << i;
    }
  }
}

TEST(Climb, OfOneGaussianEndsAtItsMean) {
  const Gaussian g = Gaussian::from_parameters({3, -2}, 0.5, 4.0, 0.8);
  const Vec2 top = climb({DensityPart(g, 1.0)}, {4, 1});
  EXPECT_LT((top - g.mean_m()).norm(), 1e-9) << "one step of the mean shift leads there";
}

TEST(Climb, StaysWhereNothingIsNear) {
  const Vec2 from(1000, 1000);
  EXPECT_EQ(climb({}, from), from);
  EXPECT_EQ(climb({DensityPart(Gaussian::from_parameters({0, 0}, 1, 1, 0), 1.0)}, from), from);
}

}  // namespace
}  // namespace swarm::planner
