// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/density_cap.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_core/gmm/wasserstein.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::planner {
namespace {

Gaussian disc(double x, double y, double sigma_m) {
  return Gaussian::from_parameters({x, y}, sigma_m, sigma_m, 0.0);
}

Gaussian random_gaussian(Rng& rng) {
  return Gaussian::from_parameters({uniform(rng, -20, 20), uniform(rng, -20, 20)},
                                   uniform(rng, 0.2, 8.0), uniform(rng, 0.2, 8.0),
                                   uniform(rng, -0.9, 0.9));
}

TEST(DensityCap, CapacityIsTheMassWhosePeakIsTheLimit) {
  Rng rng(1);
  for (int i = 0; i < 200; ++i) {
    const Gaussian g = random_gaussian(rng);
    const DensityCap cap{.max_per_m2 = uniform(rng, 0.1, 5.0), .robots = uniform(rng, 1, 1000)};

    const double mass = mass_capacity(g, cap);

    EXPECT_NEAR(cap.robots * mass * g.density(g.mean_m()), cap.max_per_m2, 1e-9);
    EXPECT_NEAR(peak_density_per_m2(g, mass, cap.robots), cap.max_per_m2, 1e-9);
  }
}

TEST(DensityCap, ALegHoldsWhatBothItsEndsHold) {
  Rng rng(2);
  const DensityCap cap{.max_per_m2 = 1.0, .robots = 100.0};
  for (int i = 0; i < 200; ++i) {
    const Gaussian a = random_gaussian(rng);
    const Gaussian b = random_gaussian(rng);
    const Geodesic geodesic(a, b);
    const double least = std::min(mass_capacity(a, cap), mass_capacity(b, cap));
    for (double t = 0.0; t <= 1.0; t += 0.02) {
      // Relative rounding of a determinant along the geodesic.
      EXPECT_GE(mass_capacity(geodesic.at(t), cap), least * (1.0 - 1e-9)) << i << " at " << t;
    }
  }
}

TEST(CheckComponents, AllowTheLimitAndNothingAbove) {
  const std::vector<Gaussian> nodes{disc(0, 0, 2.0), disc(50, 0, 2.0)};
  const std::vector<double> one{1.0};
  const double peak_per_m2 = peak_density_per_m2(nodes[0], 1.0, 40.0);

  // The density of components together is found by a search, to 1 mm of its top.
  EXPECT_TRUE(check_components(nodes, one, one,
                               {.max_per_m2 = peak_per_m2 * (1.0 + 1e-6), .robots = 40.0}));
  const auto above =
      check_components(nodes, one, one, {.max_per_m2 = peak_per_m2 * (1.0 - 1e-6), .robots = 40.0});
  ASSERT_FALSE(above.has_value());
  EXPECT_EQ(above.error().code, ErrorCode::kInfeasible);
}

TEST(CheckComponents, NameEachThatIsTooDenseWithItsRemedy) {
  // 50 robots in a Gaussian of 1 m reach 50/(2π) = 7.958 robots/m², those in 5 m a 25th of it.
  const std::vector<Gaussian> nodes{disc(0, 0, 1.0), disc(50, 0, 5.0), disc(0, 90, 5.0),
                                    disc(50, 90, 1.0)};
  const std::vector<double> halves{0.5, 0.5};

  const auto checked =
      check_components(nodes, halves, halves, {.max_per_m2 = 2.0, .robots = 100.0});

  ASSERT_FALSE(checked.has_value());
  EXPECT_EQ(checked.error().message,
            "start component 0 holds 50 of 100 robots at up to 7.958 robots/m2, the limit is "
            "2.000: widen it 1.99 times, take weight from it, or raise the limit\n"
            "goal component 1 holds 50 of 100 robots at up to 7.958 robots/m2, the limit is "
            "2.000: widen it 1.99 times, take weight from it, or raise the limit");
}

TEST(CheckComponents, NameThePositionWhereTheyAreTooDenseTogether) {
  // Each alone has 50/(2π·4) = 1.989 robots/m², both at nearly the same position twice that.
  const std::vector<Gaussian> nodes{disc(10, 20, 2.0), disc(10.002, 20, 2.0), disc(50, 0, 4.0)};
  const std::vector<double> halves{0.5, 0.5};
  const std::vector<double> one{1.0};

  const auto checked = check_components(nodes, halves, one, {.max_per_m2 = 2.0, .robots = 100.0});

  ASSERT_FALSE(checked.has_value());
  EXPECT_EQ(checked.error().message,
            "start components together reach 3.979 robots/m2 at (10.0, 20.0) m, the limit is "
            "2.000: move them apart, widen them, or raise the limit");
}

}  // namespace
}  // namespace swarm::planner
