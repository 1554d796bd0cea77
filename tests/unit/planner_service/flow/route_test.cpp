// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/flow/route.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "planner_service/flow/build_plan.hpp"
#include "swarm_core/gmm/wasserstein.hpp"
#include "swarmflow/core/random.hpp"

namespace swarm::planner {
namespace {

Gaussian round(double x, double y, double sigma_m) {
  return Gaussian::from_parameters({x, y}, sigma_m, sigma_m, 0.0);
}

// The longest path of points that are sampled on the border of the 2σ ellipse and within it.
double sampled_path_m(const Gaussian& from, const Gaussian& to) {
  const Mat2 map = transport_map(from, to);
  const Mat2 root = cholesky_lower(from.covariance_m2());
  double longest_m = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 20'000;
    for (const double radius : {2.0, 1.3, 0.0}) {
      const Vec2 y = root * (radius * Vec2(std::cos(angle), std::sin(angle)));
      const Vec2 path_m = to.mean_m() + map * y - from.mean_m() - y;
      longest_m = std::max(longest_m, path_m.norm());
    }
  }
  return longest_m;
}

TEST(EndLegs, FindTheLongestPathOfAnEllipse) {
  Rng rng(1);
  for (int round = 0; round < 200; ++round) {
    const auto gaussian = [&] {
      const Vec2 mean_m(uniform(rng, -20, 20), uniform(rng, -20, 20));
      const double sigma_m = uniform(rng, 0.5, 12.0);
      return Gaussian::from_parameters(mean_m, sigma_m, uniform(rng, 0.5, 12.0),
                                       uniform(rng, -0.8, 0.8));
    };
    const Gaussian from = gaussian();
    const Gaussian to = gaussian();
    const double sampled_m = sampled_path_m(from, to);

    const double longest_m = longest_robot_path_m(from, to);

    EXPECT_GE(longest_m, sampled_m - 1e-9);
    // The nearest sample is off by 1/40000 of a turn.
    EXPECT_LE(longest_m, sampled_m * (1.0 + 1e-6) + 1e-6);
  }
}

TEST(EndLegs, HandleLegsWithoutADirection) {
  // The mean is at rest: all directions are equally long, or two opposite ones are the longest.
  EXPECT_NEAR(longest_robot_path_m(round(3, 4, 10), round(3, 4, 2)), 16.0, 1e-9);
  const Gaussian thin = Gaussian::from_parameters({3, 4}, 10.0, 2.0, 0.0);
  EXPECT_NEAR(longest_robot_path_m(round(3, 4, 10), thin), 16.0, 1e-9);
  // The mean moves along the axis that keeps its width: √(17² + 16²).
  EXPECT_NEAR(longest_robot_path_m(round(0, 0, 10), Gaussian::from_parameters({17, 0}, 10, 2, 0)),
              std::hypot(17.0, 16.0), 1e-9);
  EXPECT_NEAR(longest_robot_path_m(round(0, 0, 2), round(5, 0, 2)), 5.0, 1e-12);
  EXPECT_EQ(longest_robot_path_m(round(1, 1, 2), round(1, 1, 2)), 0.0);
}

TEST(EndLegs, TakeAsLongAsRobotsOfTheEllipseNeed) {
  // 17 m of the mean, 17 + 2 · 8 m of a robot at the far side, and no longer than that.
  const Gaussian start = round(0, 0, 10);
  const Gaussian first = round(17, 0, 2);
  const LegSpeed speed{.means_mps = 1.25, .robots_mps = 1.4};

  EXPECT_NEAR(end_leg_duration_s(start, first, speed), 33.0 / 1.4, 1e-9);
  EXPECT_EQ(end_leg_duration_s(start, first, {1.25}), leg_duration_s(start, first, 1.25));
  // Where the shape keeps, the mean decides.
  EXPECT_NEAR(end_leg_duration_s(first, round(42, 0, 2), speed), 25.0 / 1.25, 1e-9);
}

TEST(EndLegs, AreTheFirstAndTheLastOfARoute) {
  const LegSpeed speed{.means_mps = 1.25, .robots_mps = 1.4};
  const std::vector<Route> routes{
      {0, 0, 1.0, {round(0, 0, 10), round(17, 0, 2), round(34, 0, 1), round(51, 0, 9)}}};

  const auto plan = build_plan(routes, 1, 1, speed);

  ASSERT_TRUE(plan.has_value());
  EXPECT_NEAR(plan->duration().count(), (17.0 + 16.0) / 1.4 + 17.0 / 1.25 + (17.0 + 16.0) / 1.4,
              1e-9);
}

}  // namespace
}  // namespace swarm::planner
