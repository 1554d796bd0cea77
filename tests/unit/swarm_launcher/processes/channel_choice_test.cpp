// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/processes/channel_choice.hpp"

#include <gtest/gtest.h>

namespace swarm::launcher {
namespace {

Channel choice(std::uint32_t agents, std::uint32_t robots_per_process) {
  return choose_channel({.agents = agents, .robots_per_process = robots_per_process})->channel;
}

TEST(ChannelChoice, TakesGroupsForManyProcessesOfFewRobots) {
  EXPECT_EQ(choice(1, 1), Channel::kTopics);
  EXPECT_EQ(choice(32, 1), Channel::kTopics);
  EXPECT_EQ(choice(33, 1), Channel::kGroups);
  EXPECT_EQ(choice(300, 4), Channel::kGroups);
  EXPECT_EQ(choice(300, 5), Channel::kTopics);
}

TEST(ChannelChoice, TakesTopicsWhereThereIsNoMulticast) {
  EXPECT_EQ(choose_channel({.agents = 300, .multicast = false})->channel, Channel::kTopics);
}

TEST(ChannelChoice, RefusesGroupsWhereThereIsNoMulticast) {
  const auto refused = choose_channel({.wanted = Channel::kGroups, .multicast = false});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kEnvironment);
}

TEST(ChannelChoice, FollowsTheOptionAndReportsWhy) {
  const auto asked = choose_channel({.wanted = Channel::kGroups, .agents = 1});
  ASSERT_TRUE(asked);
  EXPECT_EQ(asked->channel, Channel::kGroups);
  EXPECT_EQ(asked->reason, "as asked");
  EXPECT_EQ(choose_channel({.wanted = Channel::kTopics, .agents = 300})->channel, Channel::kTopics);
  EXPECT_EQ(choose_channel({.agents = 100})->reason, "100 agent processes, more than 32");
}

}  // namespace
}  // namespace swarm::launcher
