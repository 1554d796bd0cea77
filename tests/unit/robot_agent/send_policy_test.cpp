// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/send_policy.hpp"

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;
SteadyTime at(int ms) { return SteadyTime(milliseconds(ms)); }
SendOptions options() {
  return {.error_m = 0.05,
          .interval_max = milliseconds(500),
          .near_m = 1.0,
          .period = milliseconds(100)};
}

SendInput state(int ms, const Vec2& position_m, const Vec2& velocity_mps) {
  return {.now = at(ms),
          .position_m = position_m,
          .velocity_mps = velocity_mps,
          .listeners = {.nearest_gap_m = 10.0, .timeout_s = 10.0},
          .link = {}};
}

TEST(SendPolicy, SendsNothingWhileTheExtrapolationHolds) {
  SendPolicy sut(options());
  EXPECT_TRUE(sut.must_send(state(0, {0, 0}, {1, 0})));
  sut.record_sent(state(0, {0, 0}, {1, 0}));

  EXPECT_FALSE(sut.must_send(state(400, {0.4, 0.04}, {1, 0})));
  EXPECT_TRUE(sut.must_send(state(400, {0.4, 0.06}, {1, 0})));
}

TEST(SendPolicy, SendsBeforeATurnInvalidatesTheExtrapolation) {
  SendPolicy sut(options());
  sut.record_sent(state(0, {0, 0}, {1, 0}));

  EXPECT_FALSE(sut.must_send(state(100, {0.1, 0}, {1, 0.4})));  // 4 cm until it can publish again
  EXPECT_TRUE(sut.must_send(state(100, {0.1, 0}, {1, 0.6})));
}

TEST(SendPolicy, LooksTwoPeriodsAheadNearOthers) {
  SendPolicy sut(options());
  sut.record_sent(state(0, {0, 0}, {1, 0}));
  SendInput turned = state(100, {0.1, 0}, {1, 0.3});

  turned.listeners.nearest_gap_m = 0.6;
  EXPECT_FALSE(sut.must_send(turned)) << "3 cm until it can publish again";
  turned.listeners.nearest_gap_m = 0.4;
  EXPECT_TRUE(sut.must_send(turned)) << "6 cm until the command of a frozen process runs out";
}

TEST(SendPolicy, IsMoreExactWhereItAlmostTouches) {
  SendPolicy sut(options());
  sut.record_sent(state(0, {0, 0}, {0, 0}));
  SendInput moved = state(100, {0.03, 0}, {0, 0});

  EXPECT_FALSE(sut.must_send(moved));
  moved.listeners.nearest_gap_m = 0.1;
  EXPECT_TRUE(sut.must_send(moved));
  moved.position_m = {0.009, 0};
  moved.listeners.nearest_gap_m = 0.0;
  EXPECT_FALSE(sut.must_send(moved)) << "a centimetre never matters";
}

TEST(SendPolicy, SendsAtLeastOncePerInterval) {
  SendPolicy sut(options());
  sut.record_sent(state(0, {0, 0}, {0, 0}));

  EXPECT_FALSE(sut.must_send(state(499, {0, 0}, {0, 0})));
  EXPECT_TRUE(sut.must_send(state(500, {0, 0}, {0, 0})));
}

TEST(SendPolicy, SendsBeforeFollowersTimeOut) {
  SendPolicy sut(options());
  sut.record_sent(state(0, {0, 0}, {1, 0}));
  SendInput followed = state(200, {0.2, 0}, {1, 0});

  followed.listeners.timeout_s = 0.31;  // what is published at the next tick comes in time
  EXPECT_FALSE(sut.must_send(followed));
  followed.link.late_s = 0.15;
  EXPECT_TRUE(sut.must_send(followed));
  followed.link.late_s = 0.0;
  followed.listeners.timeout_s = 0.29;
  EXPECT_TRUE(sut.must_send(followed));
}

TEST(SendPolicy, SendsAtEveryTickNearOthersOnADegradedLinkUnlessStopped) {
  SendPolicy sut(options());
  sut.record_sent(state(0, {0, 0}, {0.5, 0}));
  SendInput near = state(100, {0.05, 0}, {0.5, 0});
  near.listeners.nearest_gap_m = 0.99;

  EXPECT_FALSE(sut.must_send(near));
  near.link.poor = true;
  EXPECT_TRUE(sut.must_send(near));

  sut.record_sent(state(200, {0, 0}, {0, 0}));
  SendInput is_stopped = state(300, {0, 0}, {0, 0});
  is_stopped.listeners.nearest_gap_m = 0.99;
  is_stopped.link.poor = true;
  EXPECT_FALSE(sut.must_send(is_stopped));
}

}  // namespace
}  // namespace swarm::agent
