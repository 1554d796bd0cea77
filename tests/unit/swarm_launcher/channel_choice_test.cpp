// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/channel_choice.hpp"

#include <gtest/gtest.h>

namespace swarm::launcher {
namespace {

TEST(ChannelChoice, TakesGroupsForManyProcessesOfFewRobots) {
  EXPECT_EQ(choose_channel({}, 1, 1).channel, Channel::kTopics);
  EXPECT_EQ(choose_channel({}, 32, 1).channel, Channel::kTopics);
  EXPECT_EQ(choose_channel({}, 33, 1).channel, Channel::kGroups);
  EXPECT_EQ(choose_channel({}, 300, 4).channel, Channel::kGroups);
  EXPECT_EQ(choose_channel({}, 300, 5).channel, Channel::kTopics);
}

TEST(ChannelChoice, ObeysAndSaysWhy) {
  EXPECT_EQ(choose_channel(Channel::kTopics, 300, 1).channel, Channel::kTopics);
  EXPECT_EQ(choose_channel(Channel::kGroups, 1, 100).channel, Channel::kGroups);
  EXPECT_EQ(choose_channel(Channel::kGroups, 1, 100).reason, "as asked");
  EXPECT_EQ(choose_channel({}, 100, 1).reason, "100 agent processes, more than 32");
}

}  // namespace
}  // namespace swarm::launcher
