// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/roadmap/means.hpp"

#include <array>

#include <gtest/gtest.h>

namespace swarm::planner {
namespace {

TEST(HaltonMeans, FillStripsEvenlyForEverySeed) {
  const Box box{{-3, 10}, {29, 91}};  // 32 m × 81 m: strips of 1/32 and 1/81 are 1 m
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Rng rng(seed);
    HaltonMeans means(box, rng);
    std::array<int, 32> columns{};
    std::array<int, 81> rows{};
    for (int i = 0; i < 32 * 81; ++i) {
      const Vec2 p = means.next();
      ASSERT_TRUE(box.contains(p));
      ++columns[static_cast<std::size_t>(p.x() - box.min_m.x())];
      ++rows[static_cast<std::size_t>(p.y() - box.min_m.y())];
    }

    // Unshifted, every strip gets its exact share; the shift cuts each strip into two partial ones,
    // each off by at most one point.
    for (const int count : columns) EXPECT_NEAR(count, 81, 2);
    for (const int count : rows) EXPECT_NEAR(count, 32, 2);
  }
}

TEST(HaltonMeans, DifferBetweenSeeds) {
  Rng a(1);
  Rng b(2);

  EXPECT_NE(HaltonMeans({{0, 0}, {1, 1}}, a).next(), HaltonMeans({{0, 0}, {1, 1}}, b).next());
}

TEST(NearObstacleMean, IsFreeInBoundsAndNearTheObstacle) {
  const World world =
      World::make({{0, 0}, {100, 100}}, {Circle{{50, 50}, 10.0}, Circle{{0, 50}, 5.0}}).value();
  Rng rng(3);
  int answers = 0;
  double distance_sum_m = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    const auto mean = near_obstacle_mean(world, 4.0, 1.0, rng);
    if (!mean) continue;
    ++answers;
    EXPECT_TRUE(world.bounds_m().contains(*mean));
    EXPECT_GT(world.distance_m(*mean), 1.0);
    distance_sum_m += world.distance_m(*mean);
  }

  ASSERT_GT(answers, 100);
  // Uniform free points are 24 m away on average; half the spread of the pairs is the scale here.
  EXPECT_LT(distance_sum_m / answers, 5.0);
}

}  // namespace
}  // namespace swarm::planner
