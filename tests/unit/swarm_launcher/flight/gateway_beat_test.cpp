// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/gateway_beat.hpp"

#include <chrono>

#include <gtest/gtest.h>
#include <unistd.h>

namespace swarm::launcher {
namespace {

const pid_t kSelf = ::getpid();

SteadyTime at(Duration since_begin) { return SteadyTime(std::chrono::hours(1)) + since_begin; }

TEST(GatewayBeat, IsReceivedOnceFromTheGatewayThatSentIt) {
  GatewayBeatReceiver launcher(kSelf);
  GatewayBeatSender gateway(kSelf);
  EXPECT_FALSE(launcher.take(kSelf));
  gateway.step(at(Duration{}));
  EXPECT_TRUE(launcher.take(kSelf));
  EXPECT_FALSE(launcher.take(kSelf));
  gateway.step(at(kGatewayBeatPeriod));
  EXPECT_FALSE(launcher.take(kSelf + 1)) << "of one before";
}

TEST(GatewayBeat, IsSentOnceAPeriod) {
  GatewayBeatReceiver launcher(kSelf);
  GatewayBeatSender gateway(kSelf);
  gateway.step(at(Duration{}));
  ASSERT_TRUE(launcher.take(kSelf));
  gateway.step(at(kGatewayBeatPeriod - std::chrono::milliseconds(1)));
  EXPECT_FALSE(launcher.take(kSelf));
  gateway.step(at(kGatewayBeatPeriod));
  EXPECT_TRUE(launcher.take(kSelf));
}

TEST(GatewayBeat, BlocksNoGatewayWhoseLauncherDoesNotRead) {
  GatewayBeatSender lonely(kSelf);
  lonely.step(at(Duration{}));
  GatewayBeatReceiver launcher(kSelf);
  GatewayBeatSender gateway(kSelf);
  for (int i = 0; i < 10'000; ++i) gateway.step(at(i * kGatewayBeatPeriod));
  EXPECT_TRUE(launcher.take(kSelf));
}

}  // namespace
}  // namespace swarm::launcher
