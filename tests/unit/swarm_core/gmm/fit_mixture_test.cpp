// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/gmm/fit_mixture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace swarm {
namespace {

Vec2 sample(const Gaussian& g, Rng& rng) {
  const double u = standard_normal(rng);
  const Vec2 z(u, standard_normal(rng));
  return g.mean_m() + cholesky_lower(g.covariance_m2()) * z;
}

std::vector<Patch> drawn_from(const Mixture& mixture, std::size_t count, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<Patch> patches;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t j = mixture.component_at(uniform01(rng));
    patches.push_back({1.0, sample(mixture.components()[j].gaussian, rng), Mat2::Zero()});
  }
  return patches;
}

Mixture three_components() {
  return Mixture::make({{0.5, Gaussian::from_parameters({0, 0}, 1.0, 2.0, 0.5)},
                        {0.3, Gaussian::from_parameters({12, 3}, 1.5, 1.0, 0.0)},
                        {0.2, Gaussian::from_parameters({4, 14}, 2.0, 1.0, -0.6)}})
      .value();
}

std::vector<Patch> two_lines_and_a_dot() {
  std::vector<Patch> patches;
  for (int i = 0; i < 40; ++i) {
    patches.push_back({1.0, {0.5 * i, 0.0}, 0.02 * Mat2::Identity()});
    patches.push_back({2.0, {0.0, 0.5 * i}, 0.02 * Mat2::Identity()});
  }
  patches.push_back({0.01, {30.0, 30.0}, Mat2::Zero()});
  return patches;
}

TEST(FitMixture, FindsTheMixtureThatPointsWereDrawnFrom) {
  const Mixture truth = three_components();
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const std::vector<Patch> patches = drawn_from(truth, 10'000, seed);
    Rng rng(seed);

    const auto fit = fit_mixture(patches, {.components = 3, .sigma_min_m = 0.1}, rng);

    ASSERT_TRUE(fit.has_value());
    ASSERT_EQ(fit->mixture.components().size(), 3U);
    for (const auto& [weight, gaussian] : truth.components()) {
      const auto& found = fit->mixture.components();
      const auto nearest =
          std::min_element(found.begin(), found.end(), [&](const auto& a, const auto& b) {
            return (a.gaussian.mean_m() - gaussian.mean_m()).norm() <
                   (b.gaussian.mean_m() - gaussian.mean_m()).norm();
          });
      // Five standard errors with n ≥ 2000 points a component: of a share √(ω(1−ω)/10⁴) ≤ 0.005, of
      // a mean σ/√n ≤ 0.045, of a variance σ²√(2/n) ≤ 0.13.
      EXPECT_NEAR(nearest->weight, weight, 0.025);
      EXPECT_LT((nearest->gaussian.mean_m() - gaussian.mean_m()).norm(), 0.3);
      EXPECT_LT(
          (nearest->gaussian.covariance_m2() - gaussian.covariance_m2()).cwiseAbs().maxCoeff(),
          0.65);
    }
  }
}

TEST(FitMixture, BicFindsTheNumberOfComponents) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const std::vector<Patch> patches = drawn_from(three_components(), 2'000, seed);
    Rng rng(seed);

    const auto fit = fit_mixture(patches, {.sigma_min_m = 0.1}, rng);

    ASSERT_TRUE(fit.has_value());
    EXPECT_EQ(fit->mixture.components().size(), 3U) << "seed " << seed;
  }
}

TEST(FitMixture, LikelihoodNeverFalls) {
  // Covariances at their floor and patches with an extent: a wrong M-step would lower F here.
  for (const double sigma_min_m : {0.01, 0.5, 2.0}) {
    for (std::uint32_t components = 1; components <= 12; ++components) {
      Rng rng(components);

      const auto fit = fit_mixture(
          two_lines_and_a_dot(),
          {.components = components, .sigma_min_m = sigma_min_m, .tolerance = 1e-12}, rng);

      ASSERT_TRUE(fit.has_value());
      const std::vector<double>& history = fit->mean_log_likelihood;
      ASSERT_GE(history.size(), 2U);
      for (std::size_t i = 1; i < history.size(); ++i) {
        // Rounding of a sum of 81 logarithms; components that own 1e-12 of the weight are dropped.
        EXPECT_GE(history[i], history[i - 1] - 1e-10) << "iteration " << i;
      }
    }
  }
}

TEST(FitMixture, ReportsTheLikelihoodOfItsPoints) {
  // For points F is the mean log-likelihood; the last maximisation comes before the last F.
  const std::vector<Patch> points = drawn_from(three_components(), 500, 3);
  Rng rng(1);

  const auto fit = fit_mixture(points, {.components = 3, .sigma_min_m = 0.1}, rng);

  ASSERT_TRUE(fit.has_value());
  double sum = 0.0;
  for (const Patch& point : points) sum += std::log(fit->mixture.density(point.center_m));
  EXPECT_NEAR(fit->mean_log_likelihood.back(), sum / 500.0, 1e-9);  // rounding of 500 logarithms
}

TEST(FitMixture, OneComponentHasTheShapesOwnMoments) {
  std::vector<Patch> patches{{1.0, {1, 2}, 0.5 * Mat2::Identity()},
                             {3.0, {5, 4}, 2.0 * Mat2::Identity()}};
  Rng rng(1);

  const auto fit = fit_mixture(patches, {.components = 1, .sigma_min_m = 0.01}, rng);

  ASSERT_TRUE(fit.has_value());
  // By hand: mean (1·(1,2) + 3·(5,4))/4; spread (0.5 + 3·2)/4; between the centres 3/16 ddᵀ.
  const Gaussian& g = fit->mixture.components()[0].gaussian;
  Mat2 covariance;
  covariance << 1.625 + 3.0, 1.5, 1.5, 1.625 + 0.75;
  EXPECT_LT((g.mean_m() - Vec2(4, 3.5)).norm(), 1e-12);
  EXPECT_LT((g.covariance_m2() - covariance).norm(), 1e-12);
}

TEST(FitMixture, DropsWhatIsTooLight) {
  Rng rng(1);

  const auto fit = fit_mixture(two_lines_and_a_dot(), {.components = 8}, rng);

  ASSERT_TRUE(fit.has_value());
  double sum = 0.0;
  for (const auto& [weight, gaussian] : fit->mixture.components()) {
    EXPECT_GE(weight, 1e-3);
    EXPECT_LT(gaussian.mean_m().norm(), 21.0);  // the dot of weight 1e-4 at (30, 30) is dropped
    sum += weight;
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
}

TEST(FitMixture, IsTheSameForTheSameGenerator) {
  const std::vector<Patch> patches = two_lines_and_a_dot();
  for (const std::uint32_t components : {0U, 7U}) {
    Rng first(9);
    Rng second(9);

    const auto a = fit_mixture(patches, {.components = components}, first);
    const auto b = fit_mixture(patches, {.components = components}, second);

    ASSERT_TRUE(a.has_value() && b.has_value());
    EXPECT_EQ(a->mean_log_likelihood, b->mean_log_likelihood);
    ASSERT_EQ(a->mixture.components().size(), b->mixture.components().size());
    for (std::size_t j = 0; j < a->mixture.components().size(); ++j) {
      EXPECT_EQ(a->mixture.components()[j].gaussian.mean_m(),
                b->mixture.components()[j].gaussian.mean_m());
    }
  }
}

TEST(FitMixture, KeepsTheFloorOnDegenerateShapes) {
  std::vector<Patch> line;
  for (int i = 0; i <= 10; ++i) line.push_back({1.0, {1e5 + i, 2e5 + 2.0 * i}, Mat2::Zero()});
  const std::vector<std::vector<Patch>> shapes{
      {{1.0, {3, 4}, Mat2::Zero()}},
      std::vector<Patch>(50, {0.1, {-7, 1e6}, Mat2::Zero()}),
      line,
  };
  for (const std::vector<Patch>& shape : shapes) {
    for (const std::uint32_t components : {0U, 1U, 5U, 255U}) {
      Rng rng(1);

      const auto fit = fit_mixture(shape, {.components = components, .sigma_min_m = 0.3}, rng);

      ASSERT_TRUE(fit.has_value()) << fit.error().message;
      EXPECT_LE(fit->mixture.components().size(), shape.size());
      for (const auto& [weight, gaussian] : fit->mixture.components()) {
        EXPECT_GE(gaussian.min_sigma_m(), 0.3 - 1e-9);  // rounding of 1e-10 m² in a variance
      }
    }
  }
}

TEST(FitMixture, RefusesWhatIsNoShape) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Patch good{1.0, {0, 0}, Mat2::Zero()};
  const std::vector<std::vector<Patch>> shapes{
      {},
      {{0.0, {0, 0}, Mat2::Zero()}},
      {good, {-1.0, {1, 0}, Mat2::Zero()}},
      {good, {nan, {1, 0}, Mat2::Zero()}},
      {good, {1.0, {nan, 0}, Mat2::Zero()}},
      {good, {1.0, {1, 0}, nan * Mat2::Identity()}},
  };
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    Rng rng(1);

    const auto fit = fit_mixture(shapes[i], {}, rng);

    ASSERT_FALSE(fit.has_value()) << "shape " << i;
    EXPECT_EQ(fit.error().code, ErrorCode::kBadInput);
  }
  for (const FitOptions& options :
       {FitOptions{.components = 256}, FitOptions{.components_max = 0},
        FitOptions{.sigma_min_m = 0.0}, FitOptions{.sigma_min_m = nan}, FitOptions{.starts = 0}}) {
    Rng rng(1);
    EXPECT_FALSE(fit_mixture(std::vector<Patch>{good}, options, rng).has_value());
  }
}

}  // namespace
}  // namespace swarm
