// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/route/guide_points.hpp"

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

// A wall that the path goes around:
//
//   12   . 1 ------ 2 .
//   10       ####
//    5   0   ####     3
//
World walled() {
  return World::make({{0, 0}, {20, 20}},
                     {Polygon::make({{8, 0}, {12, 0}, {12, 10}, {8, 10}}).value()})
      .value();
}

const Polyline kPath({{2, 5}, {6, 12}, {14, 12}, {18, 5}});

TEST(GuidePoints, GoesForTheFarthestInSight) {
  GuidePoints sut(kPath, GuidePointsOptions{.sight_m = 30.0});

  EXPECT_EQ(sut.update({2, 5}, walled()), Vec2(6, 12));
  EXPECT_FALSE(sut.is_last());
  EXPECT_NEAR(sut.remaining_m({2, 5}), kPath.length_m(), 1e-9);
}

TEST(GuidePoints, GoesOnWithinTheGoalRadius) {
  GuidePoints sut(kPath, GuidePointsOptions{.goal_radius_m = 1.0, .sight_m = 0.0, .look_every = 1});

  EXPECT_EQ(sut.update({2, 5.5}, walled()), Vec2(6, 12));
  EXPECT_EQ(sut.update({5, 11.5}, walled()), Vec2(6, 12));
  EXPECT_EQ(sut.update({5.5, 11.5}, walled()), Vec2(14, 12));
}

TEST(GuidePoints, FallsBackToTheLastItSees) {
  GuidePoints sut(kPath, GuidePointsOptions{.sight_m = 30.0, .look_every = 1});
  ASSERT_EQ(sut.update({10, 13}, walled()), Vec2(18, 5));  // over the wall
  ASSERT_TRUE(sut.is_last());

  EXPECT_EQ(sut.update({6, 8}, walled()), Vec2(6, 12));  // pushed back behind it
}

TEST(GuidePoints, DoesNotFallBackFromWithinTheGoal) {
  GuidePoints sut(kPath, GuidePointsOptions{.sight_m = 30.0, .look_every = 1});
  ASSERT_EQ(sut.update({10, 13}, walled()), Vec2(18, 5));

  EXPECT_EQ(sut.update({6, 8}, walled(), true), Vec2(18, 5));
}

TEST(GuidePoints, GoesOnThroughAGapRatherThanBack) {
  // Below a block, 0.6 m above the floor; its own point is behind the block, the next beyond it.
  const World world = World::make({{0, 0}, {20, 20}},
                                  {Polygon::make({{8, 0.6}, {12, 0.6}, {12, 10}, {8, 10}}).value()})
                          .value();
  GuidePoints sut(Polyline({{2, 0.3}, {9, 12}, {18, 0.3}}),
                  GuidePointsOptions{.sight_m = 30.0, .look_every = 1});
  ASSERT_EQ(sut.update({2, 5}, world), Vec2(9, 12));

  EXPECT_EQ(sut.update({10, 0.3}, world), Vec2(18, 0.3));
}

TEST(GuidePoints, KeepsItsPointWhenItSeesNone) {
  const World cell = World::make({{0, 0}, {20, 20}},
                                 {Polygon::make({{1, 1}, {4, 1}, {4, 1.5}, {1, 1.5}}).value(),
                                  Polygon::make({{1, 3}, {4, 3}, {4, 3.5}, {1, 3.5}}).value(),
                                  Polygon::make({{0.5, 1}, {1, 1}, {1, 3.5}, {0.5, 3.5}}).value(),
                                  Polygon::make({{4, 1}, {4.5, 1}, {4.5, 3.5}, {4, 3.5}}).value()})
                         .value();
  GuidePoints sut(kPath, GuidePointsOptions{.look_every = 1});

  const Vec2 before = sut.update({6, 12}, cell);
  EXPECT_EQ(sut.update({2.5, 2.25}, cell), before);
}

TEST(GuidePoints, EndsAtTheEnd) {
  GuidePoints sut(kPath, GuidePointsOptions{.look_every = 1});
  for (const Vec2& p : {Vec2(2, 5), Vec2(6, 12), Vec2(14, 12), Vec2(18, 5), Vec2(18, 5)}) {
    sut.update(p, walled());
  }

  EXPECT_TRUE(sut.is_last());
  EXPECT_NEAR(sut.remaining_m({18, 6}), 1.0, 1e-12);
}

}  // namespace
}  // namespace swarm::agent
