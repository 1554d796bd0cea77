// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/route/pursuit.hpp"

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

//   y
//   │        ┌── 20,20
//   │  wall  │
//   └────────┘ 20,0         path: (0,0) → (20,0) → (20,20), wall inside the corner
World corner_world() {
  return *World::make({{-10, -10}, {40, 40}},
                      {*Polygon::make({{2, 2}, {18, 2}, {18, 30}, {2, 30}})});
}

PursuitOptions options() { return {.look_ahead_m = 12.0, .radius_m = 0.2}; }

TEST(Pursuit, AimsOnlyAtWhatItSees) {
  const World world = corner_world();
  Pursuit sut(Polyline({{0, 0}, {20, 0}, {20, 20}}), world, options());

  const auto aim = sut.update({11, 0}, world);

  EXPECT_TRUE(aim.visible);
  EXPECT_TRUE(world.segment_is_free({11, 0}, aim.point_m, 0.2));
  EXPECT_GT(aim.point_m.x(), 15.0);
}

TEST(Pursuit, ReachesTheEndAroundTheCorner) {
  const World world = corner_world();
  Pursuit sut(Polyline({{0, 0}, {20, 0}, {20, 20}}), world, options());
  Vec2 robot(0, 0);
  double walked = 0.0;
  for (int step = 0; step < 400 && (robot - Vec2(20, 20)).norm() > 0.05; ++step) {
    const auto aim = sut.update(robot, world);
    const Vec2 path = aim.point_m - robot;
    const Vec2 move = path.norm() < 0.15 ? path : Vec2(0.15 * path.normalized());
    robot += move;
    walked += move.norm();
    ASSERT_GT(world.distance_m(robot), 0.2);
  }

  EXPECT_LT((robot - Vec2(20, 20)).norm(), 0.05);
  EXPECT_LT(walked, 40.0);  // it may cut the corner, but drives no farther than the path
}

// The clearance planned there, 2 m, is not to be had any more.
TEST(Pursuit, PassesAnObstacleThatAppearedBesideThePath) {
  const World before = *World::make({{-10, -10}, {40, 40}}, {});
  const World after = *World::make({{-10, -10}, {40, 40}}, {Circle{{10, 1.2}, 0.3}});
  Pursuit sut(Polyline({{0, 0}, {20, 0}}), before, options());
  Vec2 robot(0, 0);
  for (int step = 0; step < 150; ++step) {
    const Vec2 path = sut.update(robot, step < 40 ? before : after).point_m - robot;
    robot += path.norm() < 0.15 ? path : Vec2(0.15 * path.normalized());
  }

  EXPECT_LT((robot - Vec2(20, 0)).norm(), 0.05);
}

TEST(Pursuit, FallsBackToThePathWhenPushedAroundACorner) {
  const World world = corner_world();
  Pursuit sut(Polyline({{0, 0}, {20, 0}, {20, 20}}), world, options());
  for (double x = 0; x <= 20; x += 0.5) sut.update({x, 0}, world);
  for (double y = 0; y <= 10; y += 0.5) sut.update({20, y}, world);

  const auto aim = sut.update({10, 0}, world);  // pushed back behind the wall

  EXPECT_TRUE(aim.visible);
  EXPECT_TRUE(world.segment_is_free({10, 0}, aim.point_m, 0.2));
}

}  // namespace
}  // namespace swarm::agent
