// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/cli/shared_options.hpp"

#include <optional>
#include <string>

#include <gtest/gtest.h>
#include <stdlib.h>

namespace swarm::launcher::cli {
namespace {

/// The options as a command has them, after parsing a command line.
struct Parsed {
  explicit Parsed(const std::string& command_line) {
    CLI::App app;
    add_channel(app, channel);
    add_domain(app, domain);
    add_join_token(app, token);
    try {
      app.parse(command_line);
    } catch (const CLI::ParseError& e) {
      refused = e.what();
    }
  }
  std::optional<Channel> channel = Channel::kGroups;
  int domain = -1;
  std::string token;
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

TEST(JoinTokenOption, ComesFromTheCommandLineOrTheEnvironment) {
  EXPECT_EQ(Parsed("").token, "");
  EXPECT_EQ(Parsed("--join-token s3cret").token, "s3cret");
  ::setenv("SWARMFLOW_JOIN_TOKEN", "other", 1);
  EXPECT_EQ(Parsed("").token, "other");
  EXPECT_EQ(Parsed("--join-token s3cret").token, "s3cret");
  ::unsetenv("SWARMFLOW_JOIN_TOKEN");
}

TEST(JoinTokenOption, IsShortAndPrintable) {
  EXPECT_EQ(Parsed("--join-token " + std::string(256, 'x')).refused, "");
  for (const std::string& wrong :
       {std::string(257, 'x'), std::string("a\tb"), std::string("\xC2\x9B")}) {
    EXPECT_FALSE(Parsed("--join-token=\"" + wrong + "\"").refused.empty()) << wrong;
  }
}

}  // namespace
}  // namespace swarm::launcher::cli
