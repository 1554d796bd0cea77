// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/say_policy.hpp"

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;
SteadyTime at(int ms) { return SteadyTime(milliseconds(ms)); }
SayOptions options() {
  return {.error_m = 0.05,
          .interval_max = milliseconds(500),
          .near_m = 1.0,
          .period = milliseconds(100)};
}

SayInput state(int ms, const Vec2& position_m, const Vec2& velocity_mps) {
  return {.now = at(ms),
          .position_m = position_m,
          .velocity_mps = velocity_mps,
          .listeners = {.nearest_gap_m = 10.0, .patience_s = 10.0},
          .link = {}};
}

TEST(SayPolicy, StaysSilentWhileOthersExtrapolateRight) {
  SayPolicy sut(options());
  EXPECT_TRUE(sut.must_say(state(0, {0, 0}, {1, 0})));
  sut.said(state(0, {0, 0}, {1, 0}));

  EXPECT_FALSE(sut.must_say(state(400, {0.4, 0.04}, {1, 0})));
  EXPECT_TRUE(sut.must_say(state(400, {0.4, 0.06}, {1, 0})));
}

TEST(SayPolicy, SpeaksBeforeATurnTakesItAway) {
  SayPolicy sut(options());
  sut.said(state(0, {0, 0}, {1, 0}));

  EXPECT_FALSE(sut.must_say(state(100, {0.1, 0}, {1, 0.4})));  // 4 cm until it can speak again
  EXPECT_TRUE(sut.must_say(state(100, {0.1, 0}, {1, 0.6})));
}

TEST(SayPolicy, IsMoreExactWhereItAlmostTouches) {
  SayPolicy sut(options());
  sut.said(state(0, {0, 0}, {0, 0}));
  SayInput moved = state(100, {0.03, 0}, {0, 0});

  EXPECT_FALSE(sut.must_say(moved));
  moved.listeners.nearest_gap_m = 0.1;
  EXPECT_TRUE(sut.must_say(moved));
  moved.position_m = {0.009, 0};
  moved.listeners.nearest_gap_m = 0.0;
  EXPECT_FALSE(sut.must_say(moved)) << "a centimetre never matters";
}

TEST(SayPolicy, SpeaksAtLeastEveryInterval) {
  SayPolicy sut(options());
  sut.said(state(0, {0, 0}, {0, 0}));

  EXPECT_FALSE(sut.must_say(state(499, {0, 0}, {0, 0})));
  EXPECT_TRUE(sut.must_say(state(500, {0, 0}, {0, 0})));
}

TEST(SayPolicy, SpeaksBeforeThoseWhoFollowLosePatience) {
  SayPolicy sut(options());
  sut.said(state(0, {0, 0}, {1, 0}));
  SayInput followed = state(200, {0.2, 0}, {1, 0});

  followed.listeners.patience_s = 0.31;  // what is said at the next tick comes in time
  EXPECT_FALSE(sut.must_say(followed));
  followed.link.late_s = 0.15;
  EXPECT_TRUE(sut.must_say(followed));
  followed.link.late_s = 0.0;
  followed.listeners.patience_s = 0.29;
  EXPECT_TRUE(sut.must_say(followed));
}

TEST(SayPolicy, SpeaksAtEveryTickNearOthersWhereWordsAreLostUnlessItStands) {
  SayPolicy sut(options());
  sut.said(state(0, {0, 0}, {0.5, 0}));
  SayInput near = state(100, {0.05, 0}, {0.5, 0});
  near.listeners.nearest_gap_m = 0.99;

  EXPECT_FALSE(sut.must_say(near));
  near.link.poor = true;
  EXPECT_TRUE(sut.must_say(near));

  sut.said(state(200, {0, 0}, {0, 0}));
  SayInput stands = state(300, {0, 0}, {0, 0});
  stands.listeners.nearest_gap_m = 0.99;
  stands.link.poor = true;
  EXPECT_FALSE(sut.must_say(stands));
}

}  // namespace
}  // namespace swarm::agent
