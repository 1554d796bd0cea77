// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// What a user may choose for a run, and what is refused before anything is started.
#include "swarm_launcher/flight/run_checks.hpp"

#include <string>

#include <gtest/gtest.h>

#include "swarmflow/mission/mission_file.hpp"

namespace swarm::launcher {
namespace {

using link::Vendor;

FlightOptions options_for(std::uint32_t robots = 12) {
  FlightOptions options;
  options.mission = *load_mission(std::string(SWARM_SOURCE_DIR) + "/deploy/missions/small.yaml");
  options.mission.robots.count = robots;
  return options;
}

/// Empty: accepted.
std::string refusal(const FlightOptions& options, const RunAbilities& abilities = {}) {
  const auto checked = check_run(options, abilities);
  return checked ? "" : checked.error().message;
}

bool is_refused_for(const FlightOptions& options, const std::string& reason,
                    const RunAbilities& abilities = {}) {
  const std::string message = refusal(options, abilities);
  EXPECT_NE(message.find(reason), std::string::npos) << message;
  return !message.empty();
}

TEST(CheckRun, ChoosesTopicsWithADiscoveryServerForFewProcesses) {
  const auto checked = check_run(options_for(), {});
  ASSERT_TRUE(checked);
  EXPECT_EQ(checked->channel.channel, Channel::kTopics);
  EXPECT_EQ(checked->relays, 0U);
}

TEST(CheckRun, NeedsARelayParticipantForEvery25AgentsOnGroups) {
  FlightOptions options = options_for(26);
  options.how.channel = Channel::kGroups;
  const auto checked = check_run(options, {});
  ASSERT_TRUE(checked);
  EXPECT_EQ(checked->relays, 2U);
}

TEST(CheckRun, RefusesFaultsThatCannotBeRead) {
  FlightOptions options = options_for();
  options.how.fault = "loss=2";
  EXPECT_NE(refusal(options), "");
}

TEST(CheckRun, RefusesMoreRobotsThanTheStartHasRoomFor) {
  EXPECT_NE(refusal(options_for(20'000)), "");
}

TEST(CheckRun, MeetsOtherHostsOnGroups) {
  FlightOptions options = options_for();
  options.how.remote = 4;
  const auto checked = check_run(options, {});
  ASSERT_TRUE(checked) << checked.error().message;
  EXPECT_EQ(checked->channel.channel, Channel::kGroups);

  options.how.channel = Channel::kTopics;
  EXPECT_TRUE(is_refused_for(options, "by --channel groups"));
}

TEST(CheckRun, LeavesWholeProcessesBesideTheRobotsOfOtherHosts) {
  FlightOptions options = options_for();
  options.per_process = 5;
  options.how.remote = 2;
  EXPECT_EQ(refusal(options), "");
  options.how.remote = 4;
  EXPECT_TRUE(is_refused_for(options, "whole processes of 5"));
  options.how.remote = 13;
  EXPECT_TRUE(is_refused_for(options, "of 12 robots that many must be there"));
}

TEST(CheckRun, RefusesGroupsWithoutMulticast) {
  FlightOptions options = options_for();
  options.how.channel = Channel::kGroups;
  EXPECT_TRUE(is_refused_for(options, "carries no multicast", {.multicast = false}));
}

TEST(CheckRun, AcceptsCycloneDdsOfAnyRoleOnGroupsOnly) {
  for (const RunVendors& dds :
       {RunVendors{.launcher = Vendor::kCycloneDds}, RunVendors{.planner = Vendor::kCycloneDds},
        RunVendors{.agents = Vendor::kCycloneDds}}) {
    FlightOptions options = options_for();
    options.how.dds = dds;
    EXPECT_TRUE(is_refused_for(options, "add --channel groups"));
    options.how.channel = Channel::kGroups;
    EXPECT_EQ(refusal(options), "");
    EXPECT_TRUE(is_refused_for(options, "built without Cyclone DDS", {.cyclonedds = false}));
  }
}

TEST(CheckRun, UsesCycloneDdsForAllRolesInABuildWithNothingElse) {
  const auto checked = check_run(options_for(), {.fastdds = false});
  ASSERT_TRUE(checked);
  EXPECT_FALSE(checked->options.how.dds.any(Vendor::kFastDds));
  EXPECT_EQ(checked->channel.channel, Channel::kGroups);
}

TEST(CheckRun, RefusesAGatewayWithoutFastDds) {
  FlightOptions options = options_for();
  options.how.by_gateway = 2;
  options.how.channel = Channel::kGroups;
  EXPECT_EQ(refusal(options), "");
  EXPECT_TRUE(is_refused_for(options, "--by-gateway", {.fastdds = false}));
}

}  // namespace
}  // namespace swarm::launcher
