// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/core/cvar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"

namespace swarm {
namespace {

Polygon box(double x0, double y0, double x1, double y1) {
  return Polygon::make({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}).value();
}

World world_of(std::vector<Obstacle> obstacles) {
  return World::make({{-1000, -1000}, {1000, 1000}}, std::move(obstacles)).value();
}

double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

double normal_pdf(double x) { return std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi); }

TEST(NormalQuantile, MatchesTabulatedValues) {
  // Published to 15 digits.
  EXPECT_NEAR(standard_normal_quantile(0.5), 0.0, 1e-12);
  EXPECT_NEAR(standard_normal_quantile(0.95), 1.644853626951472, 1e-12);
  EXPECT_NEAR(standard_normal_quantile(0.975), 1.959963984540054, 1e-12);
  EXPECT_NEAR(standard_normal_quantile(0.99), 2.326347874040841, 1e-12);
  EXPECT_NEAR(standard_normal_quantile(0.001), -3.090232306167813, 1e-12);
  EXPECT_NEAR(standard_normal_quantile(1e-9), -5.997807015007687, 1e-12);
}

TEST(NormalQuantile, InvertsTheDistribution) {
  for (double p = 1e-15; p < 0.5; p *= 1.37) {
    const double x = standard_normal_quantile(p);

    // The error of x is that of p over the density.
    EXPECT_LT(std::abs(normal_cdf(x) - p) / normal_pdf(x), 1e-12) << p;
    EXPECT_NEAR(standard_normal_quantile(1.0 - p), -standard_normal_quantile(1.0 - (1.0 - p)),
                1e-12);
  }
}

TEST(CvarCoefficient, MatchesQuadratureOfTheTail) {
  EXPECT_NEAR(cvar_coefficient(0.05), 2.0627, 5e-5);  // four decimals, as the paper's α is used
  for (const double alpha : {0.01, 0.05, 0.15, 0.3, 0.5, 0.9}) {
    // CVaR = 1/α ∫_{VaR}^∞ x φ(x) dx, by Simpson's rule up to 12 σ.
    const double from = standard_normal_quantile(1.0 - alpha);
    const int steps = 20'000;
    const double h = (12.0 - from) / steps;
    double sum = 0.0;
    for (int i = 0; i <= steps; ++i) {
      const double x = from + i * h;
      const double weight = (i == 0 || i == steps) ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
      sum += weight * x * normal_pdf(x);
    }

    EXPECT_NEAR(cvar_coefficient(alpha), sum * h / 3.0 / alpha, 1e-10);
  }
}

TEST(CvarCoefficient, FallsWithTheTailShare) {
  double previous = std::numeric_limits<double>::infinity();
  for (double alpha = 0.001; alpha < 1.0; alpha += 0.001) {
    const double k = cvar_coefficient(alpha);

    EXPECT_LT(k, previous);
    EXPECT_GT(k, 0.0);
    previous = k;
  }
}

TEST(ObstacleCvar, MatchesMonteCarloOnAHalfPlane) {
  // A wall so wide that the linearisation is exact: its face is the line x = 5.
  const World world = world_of({box(5, -1000, 900, 1000)});
  const Gaussian g = Gaussian::from_parameters({0, 1}, 2.0, 1.0, 0.5);
  const double alpha = 0.05;
  const Mat2 lower = cholesky_lower(g.covariance_m2());
  Rng rng(11);
  const std::size_t samples = 400'000;
  std::vector<double> losses(samples);

  for (double& loss : losses) {
    const double z1 = standard_normal(rng);
    const double z2 = standard_normal(rng);
    loss = -world.distance_m(g.mean_m() + lower * Vec2(z1, z2));
  }
  std::sort(losses.begin(), losses.end(), std::greater<>());
  const auto tail = static_cast<std::size_t>(alpha * static_cast<double>(samples));
  double sum = 0.0;
  for (std::size_t i = 0; i < tail; ++i) sum += losses[i];

  const double cvar = max_cvar_m(g, world, cvar_coefficient(alpha));
  EXPECT_DOUBLE_EQ(cvar, -5.0 + cvar_coefficient(alpha) * 2.0);
  // The tail mean of 20 000 samples with σ ≈ 0.8 m scatters by 6 mm.
  EXPECT_NEAR(cvar, sum / static_cast<double>(tail), 0.03);
}

TEST(MaxCvar, IsTheLargestOverAllObstaclesDespiteTheBoxes) {
  Rng rng(12);
  const double k = cvar_coefficient(0.05);
  for (int round = 0; round < 100; ++round) {
    std::vector<Obstacle> obstacles;
    for (int i = 0; i < 6; ++i) {
      const double x = uniform(rng, -40, 40);
      const double y = uniform(rng, -40, 40);
      if (i % 2 == 0) {
        obstacles.emplace_back(box(x, y, x + uniform(rng, 1, 20), y + uniform(rng, 1, 20)));
      } else {
        obstacles.emplace_back(Circle{{x, y}, uniform(rng, 1, 10)});
      }
    }
    const World world = world_of(std::move(obstacles));
    const Gaussian g = Gaussian::from_parameters({uniform(rng, -50, 50), uniform(rng, -50, 50)},
                                                 uniform(rng, 0.5, 8), uniform(rng, 0.5, 8),
                                                 uniform(rng, -0.9, 0.9));

    double worst = -std::numeric_limits<double>::infinity();
    for (const ConvexObstacle& obstacle : world.convex_obstacles()) {
      worst = std::max(worst, obstacle_cvar_m(g, obstacle.signed_distance(g.mean_m()), k));
    }

    EXPECT_EQ(max_cvar_m(g, world, k), worst);
    EXPECT_EQ(in_free(g, world, k, -0.2), worst <= -0.2);
    EXPECT_TRUE(in_free(g, world, k, worst));
    EXPECT_FALSE(in_free(g, world, k, worst - 1e-9));
  }
}

TEST(MaxCvar, IsMinusInfinityInAnEmptyWorld) {
  EXPECT_EQ(max_cvar_m(Gaussian(), World(), 2.0), -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(in_free(Gaussian(), World(), 2.0, -0.2));
}

}  // namespace
}  // namespace swarm
