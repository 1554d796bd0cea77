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
  gateway.send(7, at(Duration{}));
  EXPECT_EQ(launcher.take(kSelf), 7U);
  EXPECT_FALSE(launcher.take(kSelf));
  gateway.send(8, at(kGatewayBeatPeriod));
  gateway.send(9, at(2 * kGatewayBeatPeriod));
  EXPECT_EQ(launcher.take(kSelf), 9U) << "the newest";
  gateway.send(9, at(3 * kGatewayBeatPeriod));
  EXPECT_FALSE(launcher.take(kSelf + 1)) << "of one before";
}

TEST(GatewayBeat, IsDueOnceAPeriod) {
  GatewayBeatSender gateway(kSelf);
  EXPECT_TRUE(gateway.is_due(at(Duration{})));
  gateway.send(0, at(Duration{}));
  EXPECT_FALSE(gateway.is_due(at(kGatewayBeatPeriod - std::chrono::milliseconds(1))));
  EXPECT_TRUE(gateway.is_due(at(kGatewayBeatPeriod)));
}

TEST(GatewayBeat, BlocksNoGatewayWhoseLauncherDoesNotRead) {
  GatewayBeatSender lonely(kSelf);
  lonely.send(0, at(Duration{}));
  GatewayBeatReceiver launcher(kSelf);
  GatewayBeatSender gateway(kSelf);
  for (int i = 0; i < 10'000; ++i) gateway.send(0, at(i * kGatewayBeatPeriod));
  EXPECT_TRUE(launcher.take(kSelf));
}

}  // namespace
}  // namespace swarm::launcher
