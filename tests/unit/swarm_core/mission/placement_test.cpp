// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_core/mission/placement.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "swarmflow/mission/mission_file.hpp"

namespace swarm {
namespace {

Mission shipped(const char* name) {
  auto mission = load_mission(std::string(SWARM_SOURCE_DIR) + "/deploy/missions/" + name);
  EXPECT_TRUE(mission.has_value());
  return mission.value_or(Mission{});
}

TEST(StratifiedShare, MeetsEveryCumulatedWeightWithinOneRobot) {
  for (const std::uint32_t n : {1U, 7U, 100U, 499U}) {
    for (double weight = 0.0; weight <= 1.0; weight += 0.0173) {
      std::uint32_t below = 0;
      for (std::uint32_t i = 0; i < n; ++i) below += stratified_share(i, n) < weight ? 1U : 0U;
      EXPECT_LE(std::abs(below - weight * n), 1.0) << n << " robots, weight " << weight;
    }
  }
}

TEST(Placement, KeepsEveryRobotClearAndInItsComponent) {
  for (const char* name : {"small.yaml", "swarmprm_standin.yaml", "diffusion_jie.yaml"}) {
    const Mission mission = shipped(name);
    const auto positions = place_robots(mission, 5);

    ASSERT_TRUE(positions.has_value()) << positions.error().message;
    ASSERT_EQ(positions->size(), mission.robots.count);
    const double gap = mission.robots.placement_gap_m;
    for (std::uint32_t i = 0; i < mission.robots.count; ++i) {
      const Vec2& p = (*positions)[i];
      const std::size_t component =
          mission.start.component_at(stratified_share(i, mission.robots.count));
      EXPECT_TRUE(mission.start.components()[component].gaussian.contains_99(p));
      const Vec2 wall_m =
          Vec2::Constant(mission.robots.radius_m + mission.safety.obstacle_margin_m);
      EXPECT_TRUE(mission.world.bounds_m().contains(p - wall_m));
      EXPECT_TRUE(mission.world.bounds_m().contains(p + wall_m));
      EXPECT_GE(mission.world.distance_m(p), mission.robots.radius_m + gap);
      for (std::uint32_t j = 0; j < i; ++j) {
        EXPECT_GE(((*positions)[j] - p).norm(), 2 * mission.robots.radius_m + gap);
      }
    }
  }
}

TEST(Placement, IsTheSameForTheSameSeedOnly) {
  const Mission mission = shipped("small.yaml");

  const auto first = place_robots(mission, 1);
  const auto again = place_robots(mission, 1);
  const auto other = place_robots(mission, 2);

  ASSERT_TRUE(first && again && other);
  EXPECT_EQ(*first, *again);
  EXPECT_NE(*first, *other);
}

TEST(Placement, PlacesThousandsOfRobots) {
  Mission mission = shipped("swarmprm_standin.yaml");
  mission.robots.count = 5000;
  mission.robots.radius_m = 0.1;
  mission.robots.placement_gap_m = 0.3;

  const auto positions = place_robots(mission, 1);

  ASSERT_TRUE(positions.has_value()) << positions.error().message;
  EXPECT_EQ(positions->size(), 5000U);
}

TEST(Placement, DrawsAgainWhenTheLastRobotsFindNoRoom) {
  Mission mission = shipped("crops_scene3.yaml");  // a flat start that a hundred just fit in
  mission.robots.count = 100;

  for (std::uint64_t seed = 70; seed < 80; ++seed) {
    EXPECT_TRUE(place_robots(mission, seed).has_value()) << "seed " << seed;
  }
}

TEST(Placement, RefusesAComponentThatIsTooDense) {
  Mission mission = shipped("small.yaml");
  mission.robots.count = 2000;

  const auto positions = place_robots(mission, 1);

  ASSERT_FALSE(positions.has_value());
  EXPECT_EQ(positions.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(positions.error().message.find("start[0] has no room"), std::string::npos);
}

}  // namespace
}  // namespace swarm
