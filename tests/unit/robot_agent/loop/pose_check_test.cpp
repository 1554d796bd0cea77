// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/loop/pose_check.hpp"

#include <chrono>
#include <limits>

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class PoseCheckTest : public ::testing::Test {
 protected:
  static constexpr Duration kPeriod = milliseconds(100);

  CheckedPose at(const Vec2& position_m) { return measured({.position_m = position_m}); }
  CheckedPose measured(const Measurement& m) {
    now_ += kPeriod;
    return sut_.check(m, now_);
  }

  PoseCheck sut_{PoseLimits::of(BodySpec{})};  // 1.5 m/s, 0.5 s, 0.5 m
  SteadyTime now_{seconds(10)};
};

TEST_F(PoseCheckTest, TakesTheFirstPositionAndThoseThatFollow) {
  for (int i = 0; i < 20; ++i) {
    const auto pose = at({0.15 * i, 1});
    ASSERT_TRUE(pose.is_valid) << pose.why;
    EXPECT_EQ(pose.position_m, Vec2(0.15 * i, 1));
  }
}

TEST_F(PoseCheckTest, MovesAnOldPositionOnWithItsVelocity) {
  const auto pose =
      measured({.position_m = {1, 2}, .age = milliseconds(200), .velocity_mps = Vec2(1, -0.5)});
  EXPECT_TRUE(pose.is_valid);
  EXPECT_NEAR((pose.position_m - Vec2(1.2, 1.9)).norm(), 0, 1e-12);
}

TEST_F(PoseCheckTest, TakesNoVelocityThatTheBodyCannotHave) {
  EXPECT_EQ(measured({.position_m = {1, 2}, .velocity_mps = Vec2(1, 0)}).velocity_mps, Vec2(1, 0));
  for (const Vec2& wrong : {Vec2(500, 0), Vec2(0, std::numeric_limits<double>::quiet_NaN())}) {
    const auto pose =
        measured({.position_m = {1, 2}, .age = milliseconds(200), .velocity_mps = wrong});
    EXPECT_TRUE(pose.is_valid);
    EXPECT_FALSE(pose.velocity_mps.has_value());
    EXPECT_EQ(pose.position_m, Vec2(1, 2));
  }
}

TEST_F(PoseCheckTest, RefusesWhatIsInvalidOldUncertainOrNotFinite) {
  EXPECT_FALSE(measured({.is_valid = false}).is_valid);
  EXPECT_FALSE(at({std::numeric_limits<double>::quiet_NaN(), 0}).is_valid);
  EXPECT_FALSE(measured({.age = milliseconds(501)}).is_valid);
  Mat2 tilted;
  tilted << 0.2, 0.15, 0.15, 0.2;  // σ² = 0.35 along its diagonal
  EXPECT_FALSE(measured({.covariance_m2 = tilted}).is_valid);
  EXPECT_FALSE(measured({.covariance_m2 = Mat2::Constant(std::numeric_limits<double>::quiet_NaN())})
                   .is_valid);
  EXPECT_TRUE(measured({.covariance_m2 = Mat2(0.24 * Mat2::Identity())}).is_valid);
}

TEST_F(PoseCheckTest, AShortGapCostsNothing) {
  EXPECT_TRUE(at({1, 1}).is_valid);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(measured({.is_valid = false}).is_valid);
  EXPECT_TRUE(at({1.1, 1}).is_valid);
}

TEST_F(PoseCheckTest, AfterALossPositionsMustAgreeForASecond) {
  EXPECT_TRUE(at({1, 1}).is_valid);
  for (int i = 0; i < 10; ++i) measured({.is_valid = false});
  int ticks = 0;
  while (!at({1.1, 1}).is_valid) ASSERT_LT(++ticks, 20);
  EXPECT_EQ(ticks, 10);
  EXPECT_TRUE(at({1.2, 1}).is_valid);
}

TEST_F(PoseCheckTest, AJumpIsNoPositionUntilTheNextOnesAgreeWithIt) {
  EXPECT_TRUE(at({1, 1}).is_valid);
  int ticks = 0;
  for (; !at({4, 1}).is_valid; ++ticks) ASSERT_LT(ticks, 20);
  EXPECT_EQ(ticks, 10);
}

TEST_F(PoseCheckTest, PositionsThatJumpAboutNeverCount) {
  EXPECT_TRUE(at({1, 1}).is_valid);
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(at({i % 2 == 0 ? 4.0 : 9.0, 1}).is_valid) << i;
}

TEST_F(PoseCheckTest, AFrozenProcessHasNotLostItsPosition) {
  EXPECT_TRUE(at({1, 1}).is_valid);
  now_ += seconds(6);
  EXPECT_TRUE(at({1.3, 1}).is_valid);
}

}  // namespace
}  // namespace swarm::agent
