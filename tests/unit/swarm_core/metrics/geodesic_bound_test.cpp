// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/metrics/geodesic_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "swarm_core/metrics/assignment.hpp"
#include "swarm_core/metrics/shortest_paths.hpp"
#include "swarmflow/core/random.hpp"
#include "swarmflow/mission/mission_file.hpp"

namespace swarm {
namespace {

World standin() {
  auto mission =
      load_mission(std::string(SWARM_SOURCE_DIR) + "/deploy/missions/swarmprm_standin.yaml");
  EXPECT_TRUE(mission.has_value());
  return mission ? mission->world : World{};
}

std::vector<Vec2> random_points(std::size_t n, const Box& box, Rng& rng) {
  std::vector<Vec2> points;
  while (points.size() < n) {
    points.emplace_back(uniform(rng, box.min_m.x(), box.max_m.x()),
                        uniform(rng, box.min_m.y(), box.max_m.y()));
  }
  return points;
}

TEST(GeodesicBound, IsTheBestOfAllPermutationsOfShortestPaths) {
  const World world = standin();
  const ShortestPaths paths(world, 0.2);
  Rng rng(4);
  for (std::size_t n = 1; n <= 6; ++n) {
    const auto starts = random_points(n, {{5, 5}, {45, 155}}, rng);
    const auto ends = random_points(n, {{155, 5}, {195, 155}}, rng);
    const auto costs = paths.distances_m(starts, ends);
    std::vector<std::size_t> columns(n);
    std::iota(columns.begin(), columns.end(), 0);
    double best = std::numeric_limits<double>::infinity();
    do {
      double sum = 0.0;
      for (std::size_t i = 0; i < n; ++i) sum += costs[i * n + columns[i]];
      best = std::min(best, sum / static_cast<double>(n));
    } while (std::next_permutation(columns.begin(), columns.end()));

    EXPECT_NEAR(geodesic_bound_m(world, 0.2, starts, ends), best, 1e-6);
  }
}

TEST(GeodesicBound, OfTheStandInMissionIs182Metres) {
  // Mean to mean, with the masses of the optimal transport (0.25, 0.375, 0.1875, 0.1875)).
  // An independent program, also with inscribed arcs, found 182.88 m.
  const World world = standin();
  std::vector<Vec2> starts, ends;
  const auto add = [](std::vector<Vec2>& out, const Vec2& p, std::size_t n) {
    out.insert(out.end(), n, p);
  };
  add(starts, {25, 20}, 4);
  add(starts, {25, 40}, 6);
  add(starts, {25, 120}, 3);
  add(starts, {25, 140}, 3);
  add(ends, {175, 40}, 4);
  add(ends, {175, 60}, 6);
  add(ends, {175, 120}, 6);

  EXPECT_NEAR(geodesic_bound_m(world, 0.2, starts, ends), 182.88, 0.01);
}

TEST(GeodesicBound, OfNoRobotsIsZero) { EXPECT_EQ(geodesic_bound_m(standin(), 0.2, {}, {}), 0.0); }

TEST(GeodesicBound, IsInfiniteWithoutAPath) {
  auto wall = Polygon::make({{4, 0}, {5, 0}, {5, 10}, {4, 10}});
  ASSERT_TRUE(wall.has_value());
  const auto world = World::make({{0, 0}, {10, 10}}, {*wall});
  ASSERT_TRUE(world.has_value());
  const std::vector<Vec2> starts{{1, 1}, {2, 2}};

  EXPECT_EQ(geodesic_bound_m(*world, 0.2, starts, std::vector<Vec2>{{1, 3}, {7, 7}}),
            std::numeric_limits<double>::infinity());
  EXPECT_LT(geodesic_bound_m(*world, 0.2, starts, std::vector<Vec2>{{1, 3}, {3, 7}}), 10.0);
}

TEST(GeodesicBound, OfManyRobotsStaysJustBelowTheExactOne) {
  const World world = standin();
  Rng rng(6);
  const std::size_t n = kExactBoundRobots + 100;
  const auto starts = random_points(n, {{5, 5}, {45, 55}}, rng);
  const auto ends = random_points(n, {{155, 5}, {195, 55}}, rng);
  const ShortestPaths paths(world, 0.2);
  const double exact = assignment_cost(paths.distances_m(starts, ends), n) / static_cast<double>(n);

  const double bound = geodesic_bound_m(world, 0.2, starts, ends);

  EXPECT_LE(bound, exact + 1e-6);
  // Groups of up to three robots in 2000 m²: about half a metre to their centre on either side.
  EXPECT_GE(bound, exact - 2.0);
}

}  // namespace
}  // namespace swarm
