// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarmflow/robot/polyline.hpp"

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

const Polyline kStairs({{0, 0}, {10, 0}, {10, 5}, {10, 5}, {14, 5}});  // 10, 5 and 4 m

TEST(Polyline, IsAddressedByItsLength) {
  EXPECT_EQ(kStairs.length_m(), 19.0);
  EXPECT_EQ(kStairs.vertices_m().size(), 4U);  // the same vertex twice is one
  EXPECT_EQ(kStairs.at(4.0), Vec2(4, 0));
  EXPECT_EQ(kStairs.at(12.0), Vec2(10, 2));
  EXPECT_EQ(kStairs.at(19.0), Vec2(14, 5));
}

TEST(Polyline, EndsWhereItEnds) {
  EXPECT_EQ(kStairs.at(-1.0), Vec2(0, 0));
  EXPECT_EQ(kStairs.at(99.0), Vec2(14, 5));
}

TEST(Polyline, FindsASegmentFromAnyOther) {
  for (std::size_t near = 0; near < 5; ++near) {
    EXPECT_EQ(kStairs.segment(3.0, near).index, 0U);
    EXPECT_EQ(kStairs.segment(10.0, near).index, 1U);  // a vertex is the next one's
    EXPECT_EQ(kStairs.segment(17.0, near).index, 2U);
    EXPECT_EQ(kStairs.segment(19.0, near).index, 2U);
  }
}

TEST(Polyline, ASegmentHoldsItsBeginAndNotItsEnd) {
  const Polyline::Segment second = kStairs.segment(12.0);

  EXPECT_TRUE(second.holds(10.0));
  EXPECT_TRUE(second.holds(14.9));
  EXPECT_FALSE(second.holds(15.0));
  EXPECT_FALSE(second.holds(9.9));
  EXPECT_EQ(second.position(13.0).point_m, Vec2(10, 3));
  EXPECT_EQ(second.position(13.0).tangent, Vec2(0, 1));
}

TEST(Polyline, OfOnePointHasNoLengthAndNoTangent) {
  const Polyline point({{3, 4}});

  EXPECT_EQ(point.length_m(), 0.0);
  EXPECT_EQ(point.at(0.0), Vec2(3, 4));
  EXPECT_EQ(point.at(7.0), Vec2(3, 4));
  EXPECT_EQ(point.segment(0.0).position(0.0).tangent, Vec2(0, 0));
}

}  // namespace
}  // namespace swarm::agent
