// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/cli/shared_options.hpp"

#include <optional>
#include <string>

#include <gtest/gtest.h>

namespace swarm::launcher::cli {
namespace {

/// The options as a command has them, after parsing a command line.
struct Parsed {
  explicit Parsed(const std::string& command_line) {
    CLI::App app;
    add_channel(app, channel);
    add_domain(app, domain);
    try {
      app.parse(command_line);
    } catch (const CLI::ParseError& e) {
      refused = e.what();
    }
  }
  std::optional<Channel> channel = Channel::kGroups;
  int domain = -1;
  std::string refused;
};

TEST(ChannelOption, NamesAChannelOrLeavesTheChoice) {
  EXPECT_EQ(Parsed("--channel topics").channel, Channel::kTopics);
  EXPECT_EQ(Parsed("--channel groups").channel, Channel::kGroups);
  EXPECT_EQ(Parsed("--channel auto").channel, std::nullopt);
  EXPECT_EQ(Parsed("").channel, Channel::kGroups) << "as it was";
}

TEST(ChannelOption, RefusesAnythingElse) {
  for (const char* wrong : {"--channel pigeons", "--channel TOPICS", "--channel"}) {
    const Parsed parsed(wrong);
    EXPECT_FALSE(parsed.refused.empty()) << wrong;
    EXPECT_EQ(parsed.channel, Channel::kGroups) << "as it was";
  }
}

TEST(DomainOption, IsANumberWithRoomForThePortsOfARun) {
  EXPECT_EQ(Parsed("").domain, -1) << "as it was";
  for (const int good : {0, 1, 229}) {
    EXPECT_EQ(Parsed("--domain " + std::to_string(good)).domain, good);
  }
  for (const char* wrong : {"-1", "230", "4294967296", "1.5", "seven", ""}) {
    EXPECT_FALSE(Parsed(std::string("--domain=") + wrong).refused.empty()) << wrong;
  }
}

}  // namespace
}  // namespace swarm::launcher::cli
