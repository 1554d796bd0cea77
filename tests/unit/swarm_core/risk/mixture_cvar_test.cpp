// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/risk/mixture_cvar.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include "swarmflow/core/cvar.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm {
namespace {

using Line = std::vector<LineComponent>;

double density(double z) { return std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi); }

double tail_probability(const Line& line, double level) {
  double sum = 0.0;
  for (const LineComponent& c : line)
    sum += c.weight * 0.5 * std::erfc((level - c.mean_m) / c.sigma_m / std::numbers::sqrt2);
  return sum;
}

// VaR by bisection alone.
double var_by_bisection(const Line& line, double alpha) {
  double low = -1e6;
  double high = 1e6;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (tail_probability(line, middle) > alpha ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// ∫ max(y − level, 0) p(y) dy over ±12 σ, where nothing is left out, by Gauss's rule of five points
// on steps of σ/4: its error is below 1e-13 σ.
double excess_by_quadrature(const LineComponent& c, double level) {
  static constexpr std::array<std::pair<double, double>, 5> kRule{
      {{-0.9061798459386640, 0.2369268850561891},
       {-0.5384693101056831, 0.4786286704993665},
       {0.0, 0.5688888888888889},
       {0.5384693101056831, 0.4786286704993665},
       {0.9061798459386640, 0.2369268850561891}}};
  const double z0 = std::max((level - c.mean_m) / c.sigma_m, -12.0);
  const double z1 = 12.0;
  if (z0 >= z1) return 0.0;
  const int steps = static_cast<int>(std::ceil((z1 - z0) / 0.25));
  const double half = 0.5 * (z1 - z0) / steps;
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    for (const auto& [at, weight] : kRule) {
      const double z = z0 + half * (2.0 * i + 1.0 + at);
      sum += weight * (c.mean_m + z * c.sigma_m - level) * density(z);
    }
  }
  return sum * half;
}

double cvar_by_quadrature(const Line& line, double alpha) {
  const double level = var_by_bisection(line, alpha);
  double cvar = level;
  for (const LineComponent& c : line) cvar += c.weight * excess_by_quadrature(c, level) / alpha;
  return cvar;
}

// Includes degenerate mixtures: weights of 0, spreads from 1 mm to 100 m, equal components.
Line random_line(Rng& rng) {
  const auto count = 1 + static_cast<int>(uniform(rng, 0.0, 5.99));
  Line line;
  for (int j = 0; j < count; ++j) {
    const double weight = uniform01(rng) < 0.1 ? 0.0 : uniform(rng, 1e-6, 1.0);
    const double sigma = std::pow(10.0, uniform(rng, -3.0, 2.0));
    line.push_back({weight, uniform(rng, -50.0, 50.0), sigma});
    if (uniform01(rng) < 0.1) line.push_back(line.back());
  }
  line.front().weight += 1e-3;
  double total = 0.0;
  for (const LineComponent& c : line) total += c.weight;
  for (LineComponent& c : line) c.weight /= total;
  return line;
}

TEST(MixtureCvar, OfOneGaussianIsTheClosedForm) {
  for (const double alpha : {0.3, 0.05, 1e-3}) {
    const TailRisk risk = mixture_tail_risk(Line{{1.0, -3.0, 2.0}}, alpha);
    EXPECT_NEAR(risk.cvar_m, -3.0 + 2.0 * cvar_coefficient(alpha), 1e-12);
    EXPECT_NEAR(risk.var_m, -3.0 + 2.0 * standard_normal_quantile(1.0 - alpha), 1e-12);
  }
}

TEST(MixtureCvar, AgreesWithQuadrature) {
  Rng rng(1);
  for (int round = 0; round < 10'000; ++round) {
    const Line line = random_line(rng);
    const double alpha = std::pow(10.0, uniform(rng, -3.0, -0.3));

    const TailRisk risk = mixture_tail_risk(line, alpha);

    ASSERT_NEAR(tail_probability(line, risk.var_m), alpha, 1e-9);
    ASSERT_NEAR(risk.cvar_m, cvar_by_quadrature(line, alpha), 1e-8);
  }
}

TEST(MixtureCvar, HasTheGradientOfItsDifferences) {
  Rng rng(2);
  int compared = 0;
  for (int round = 0; round < 10'000; ++round) {
    Line line = random_line(rng);
    const double alpha = uniform(rng, 0.01, 0.3);
    std::vector<double> gradient(line.size());
    mixture_cvar_gradient(line, alpha, mixture_tail_risk(line, alpha).var_m, gradient);
    for (std::size_t j = 0; j < line.size(); ++j) {
      // Differences suffer where the density at the VaR is nearly nothing and the VaR jumps with
      // the weights: between two far, narrow components the function has a kink there.
      const double weight = line[j].weight;
      const double h = 1e-6 * alpha;
      if (weight < h) continue;
      line[j].weight = weight + h;
      const TailRisk above = mixture_tail_risk(line, alpha);
      line[j].weight = weight - h;
      const TailRisk below = mixture_tail_risk(line, alpha);
      line[j].weight = weight;
      if (std::abs(above.var_m - below.var_m) > 1e-4) continue;
      const double difference = (above.cvar_m - below.cvar_m) / (2.0 * h);
      // Rounding of CVaR, 1e-14, over 2h leaves 1e-8/alpha.
      ASSERT_NEAR(gradient[j], difference, 1e-6 * (1.0 + std::abs(difference)) / alpha);
      ++compared;
    }
  }
  EXPECT_GT(compared, 20'000);
}

TEST(MixtureCvar, IsNeverAboveItsLinearisation) {
  Rng rng(3);
  for (int round = 0; round < 1000; ++round) {
    Line line = random_line(rng);
    const double alpha = uniform(rng, 0.01, 0.3);
    const TailRisk here = mixture_tail_risk(line, alpha);
    std::vector<double> gradient(line.size());
    mixture_cvar_gradient(line, alpha, here.var_m, gradient);
    Line there = line;
    double total = 0.0;
    for (LineComponent& c : there) total += c.weight = uniform(rng, 0.0, 1.0);
    double linear = here.cvar_m;
    for (std::size_t j = 0; j < line.size(); ++j) {
      there[j].weight /= total;
      linear += gradient[j] * (there[j].weight - line[j].weight);
    }
    EXPECT_LE(mixture_tail_risk(there, alpha).cvar_m, linear + 1e-9);
  }
}

// The first-order distance is exact there, so a million robots drawn from the mixture must show the
// risk that is promised: within five standard errors of the sample.
TEST(MixtureCvar, IsWhatAMillionRobotsShowAtAHalfPlane) {
  const auto wall = Polygon::make({{-1e4, -1e4}, {1e4, -1e4}, {1e4, 0}, {-1e4, 0}}).value();
  const World world = World::make({{-100, -100}, {100, 100}}, {wall}).value();
  const Mixture swarm = Mixture::make({{0.7, Gaussian::from_parameters({0, 6}, 3, 2, 0.4)},
                                       {0.3, Gaussian::from_parameters({20, 9}, 1, 4, -0.3)}})
                            .value();
  const double alpha = 0.05;
  Rng rng(4);
  constexpr int kRobots = 1'000'000;
  std::vector<double> risks_m;
  risks_m.reserve(kRobots);
  for (int i = 0; i < kRobots; ++i) {
    const Gaussian& g = swarm.components()[uniform01(rng) < 0.7 ? 0 : 1].gaussian;
    const double u = standard_normal(rng);
    const Vec2 p = g.mean_m() + cholesky_lower(g.covariance_m2()) * Vec2(u, standard_normal(rng));
    risks_m.push_back(-world.distance_m(p));
  }
  std::sort(risks_m.rbegin(), risks_m.rend());
  const auto worst = static_cast<std::size_t>(alpha * kRobots);
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < worst; ++i) {
    sum += risks_m[i];
    squares += risks_m[i] * risks_m[i];
  }
  const double mean_m = sum / static_cast<double>(worst);
  const double spread_m = std::sqrt(squares / static_cast<double>(worst) - mean_m * mean_m);
  // The sampled VaR adds as much again to the error as the mean of the tail has.
  const double error_m = 2.0 * spread_m / std::sqrt(static_cast<double>(worst));

  EXPECT_NEAR(max_mixture_cvar_m(swarm, world, alpha), mean_m, 5.0 * error_m);
}

TEST(MixtureCvar, OfAWorldWithoutObstaclesIsNone) {
  const Mixture swarm = Mixture::make({{1.0, Gaussian()}}).value();
  EXPECT_EQ(max_mixture_cvar_m(swarm, World(), 0.05), -std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace swarm
