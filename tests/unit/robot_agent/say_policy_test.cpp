// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/say_policy.hpp"

#include <gtest/gtest.h>

namespace swarm::agent {
namespace {

using std::chrono::milliseconds;
SteadyTime at(int ms) { return SteadyTime(milliseconds(ms)); }
SayOptions options() { return {.error_m = 0.05, .interval_max = milliseconds(500), .near_m = 1.0}; }

TEST(SayPolicy, StaysSilentWhileOthersExtrapolateRight) {
  SayPolicy sut(options());
  EXPECT_TRUE(sut.must_say(at(0), {0, 0}, {1, 0}, 10.0));
  sut.said(at(0), {0, 0}, {1, 0});

  EXPECT_FALSE(sut.must_say(at(400), {0.4, 0.04}, {1, 0}, 10.0));
  EXPECT_TRUE(sut.must_say(at(400), {0.4, 0.06}, {1, 0}, 10.0));
}

TEST(SayPolicy, SpeaksBeforeATurnTakesItAway) {
  SayOptions looks_ahead = options();
  looks_ahead.period = milliseconds(100);
  SayPolicy sut(looks_ahead);
  sut.said(at(0), {0, 0}, {1, 0});

  EXPECT_FALSE(sut.must_say(at(100), {0.1, 0}, {1, 0.4}, 10.0));  // 4 cm until it can speak again
  EXPECT_TRUE(sut.must_say(at(100), {0.1, 0}, {1, 0.6}, 10.0));
}

TEST(SayPolicy, SpeaksAtLeastEveryInterval) {
  SayPolicy sut(options());
  sut.said(at(0), {0, 0}, {0, 0});

  EXPECT_FALSE(sut.must_say(at(499), {0, 0}, {0, 0}, 10.0));
  EXPECT_TRUE(sut.must_say(at(500), {0, 0}, {0, 0}, 10.0));
}

TEST(SayPolicy, SpeaksAtEveryTickNearOthersUnlessItStands) {
  SayPolicy sut(options());
  sut.said(at(0), {0, 0}, {0, 0});

  EXPECT_TRUE(sut.must_say(at(100), {0, 0}, {0.5, 0}, 0.99));
  EXPECT_FALSE(sut.must_say(at(100), {0, 0}, {0, 0}, 0.99));
}

}  // namespace
}  // namespace swarm::agent
