// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/route/detour.hpp"

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"
#include "swarmflow/robot/polyline.hpp"

namespace swarm::agent {
namespace {

World world_with(const std::vector<Circle>& bodies, std::vector<Obstacle> walls = {}) {
  walls.insert(walls.end(), bodies.begin(), bodies.end());
  return World::make({{0, 0}, {60, 40}}, walls, {}, bodies.size()).value();
}

/// The whole path, ends included.
std::vector<Vec2> path_of(const Vec2& from_m, const Vec2& to_m, const World& world) {
  std::vector<Vec2> path = around_bodies(from_m, to_m, world, {});
  path.insert(path.begin(), from_m);
  path.push_back(to_m);
  return path;
}

double clearance_m(const std::vector<Vec2>& path, const World& world) {
  double least_m = 1e9;
  for (std::size_t i = 1; i < path.size(); ++i) {
    for (int k = 0; k <= 200; ++k) {
      const Vec2 p = path[i - 1] + k / 200.0 * (path[i] - path[i - 1]);
      least_m = std::min(least_m, world.distance_m(p));
    }
  }
  return least_m - 0.2;
}

TEST(Detour, LeavesAFreeLineAsItIs) {
  const World world = world_with({{{30, 22}, 0.2}});
  EXPECT_TRUE(around_bodies({5, 20}, {55, 20}, world, {}).empty());
  EXPECT_EQ(beside_bodies({30, 20}, world, {}), Vec2(30, 20));
}

TEST(Detour, GoesAroundABodyOnTheShorterSide) {
  for (const double off_m : {-0.3, 0.0, 0.3}) {
    const World world = world_with({{{30, 20 + off_m}, 0.2}});
    const auto path = path_of({5, 20}, {55, 20}, world);

    ASSERT_EQ(path.size(), 3U) << off_m;
    EXPECT_GT(clearance_m(path, world), 0.3) << off_m;
    EXPECT_LE(std::abs(path[1].y() - 20.0), 0.9 + 1e-9) << off_m;
    EXPECT_LT(Polyline(path).length_m(), 50.0 + 0.1) << off_m;
    if (off_m != 0.0) {
      EXPECT_LT((path[1].y() - 20.0) * off_m, 0.0);
    }
  }
}

TEST(Detour, GoesAroundARowThatNoRobotFitsThrough) {
  const World world = world_with({{{30, 19}, 0.2}, {{30, 19.8}, 0.2}, {{30, 20.6}, 0.2}});
  const auto path = path_of({5, 20}, {55, 20}, world);
  EXPECT_GT(clearance_m(path, world), 0.2);
  EXPECT_GT(path[1].y(), 20.6) << "the shorter side";
}

TEST(Detour, GoesThroughAGapThatIsWideEnough) {
  const World world = world_with({{{30, 18}, 0.2}, {{30, 22}, 0.2}});
  EXPECT_TRUE(around_bodies({5, 20}, {55, 20}, world, {}).empty());
}

TEST(Detour, TakesTheOtherSideWhereAWallIs) {
  const Polygon wall = Polygon::make({{20, 20.5}, {40, 20.5}, {40, 30}, {20, 30}}).value();
  const World world = world_with({{{30, 19.9}, 0.2}}, {wall});
  const auto path = path_of({5, 20}, {55, 20}, world);
  ASSERT_EQ(path.size(), 3U);
  EXPECT_LT(path[1].y(), 19.9);
}

TEST(Detour, StaysStraightWhereNoSideIsFree) {
  const Polygon above = Polygon::make({{20, 20.5}, {40, 20.5}, {40, 30}, {20, 30}}).value();
  const Polygon below = Polygon::make({{20, 10}, {40, 10}, {40, 19.5}, {20, 19.5}}).value();
  const World world = world_with({{{30, 20}, 0.2}}, {above, below});
  EXPECT_TRUE(around_bodies({5, 20}, {55, 20}, world, {}).empty());
}

TEST(Detour, FindsTheBodiesThatBlockTheRestOfAPath) {
  const Polyline path({{5, 20}, {30, 20}, {30, 35}});
  const auto blocks = [&](const Vec2& body_m, double from_s_m) {
    return is_blocked_by_body(path, from_s_m, world_with({{body_m, 0.2}}), {});
  };
  EXPECT_TRUE(blocks({20, 20.4}, 0.0));
  EXPECT_TRUE(blocks({20, 20.4}, 14.0));
  EXPECT_FALSE(blocks({20, 20.4}, 16.0)) << "behind";
  EXPECT_FALSE(blocks({20, 20.6}, 0.0)) << "beside";
  EXPECT_TRUE(blocks({30.4, 30}, 16.0));
  EXPECT_TRUE(blocks({30, 35.3}, 16.0)) << "at the end";
  EXPECT_TRUE(blocks({30, 35.3}, 99.0));
  EXPECT_FALSE(blocks({30, 30}, 99.0));
  EXPECT_FALSE(is_blocked_by_body(path, 0.0, world_with({}), {}));
}

TEST(Detour, LeavesNoBodyThatBlocksTheBentPath) {
  const World world = world_with({{{30, 19}, 0.2}, {{30, 19.8}, 0.2}, {{30, 20.6}, 0.2}});
  EXPECT_TRUE(is_blocked_by_body(Polyline({{5, 20}, {55, 20}}), 0.0, world, {}));
  EXPECT_FALSE(is_blocked_by_body(Polyline(path_of({5, 20}, {55, 20}, world)), 0.0, world, {}));
}

TEST(Detour, GetsThroughAFieldOfBodies) {
  Rng rng(3);
  int bent = 0;
  double length_m = 0.0;  // on the average
  for (int i = 0; i < 300; ++i) {
    std::vector<Circle> bodies;
    for (int k = 0; k < 15; ++k) {
      bodies.push_back({{uniform(rng, 12, 48), uniform(rng, 15, 25)}, uniform(rng, 0.2, 0.35)});
    }
    const World world = world_with(bodies);
    const auto path = path_of({5, 20}, {55, 20}, world);
    bent += path.size() > 2 ? 1 : 0;
    EXPECT_GT(clearance_m(path, world), 0.0) << i;
    EXPECT_LT(Polyline(path).length_m(), 50.0 + 10.0) << i << ": the field is 10 m wide";
    length_m += Polyline(path).length_m() / 300.0;
  }
  EXPECT_LT(length_m, 50.5);
  EXPECT_GT(bent, 100) << "the field is no empty one";
}

TEST(Detour, MovesAnEndOutOfABody) {
  const World world = world_with({{{30, 20}, 0.2}});
  for (const Vec2& p : {Vec2(30, 20), Vec2(30.1, 20.2), Vec2(29.5, 20)}) {
    EXPECT_GE(world.distance_m(beside_bodies(p, world, {})) - 0.2, 0.3 - 1e-9);
  }
}

}  // namespace
}  // namespace swarm::agent
