// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_ros/ros_domain.hpp"

#include <map>

#include <gtest/gtest.h>

namespace swarm::ros {
namespace {

using Environment = std::map<std::string, std::string>;

Result<RosDomain> domain_of(const Environment& set) {
  return ros_domain([&](const char* name) {
    const auto found = set.find(name);
    return found == set.end() ? std::string() : found->second;
  });
}

TEST(RosDomain, WithoutSettingsIsTheFirstByFastDds) {
  const auto sut = domain_of({});
  ASSERT_TRUE(sut.has_value());
  EXPECT_EQ(sut->vendor, link::Vendor::kFastDds);
  EXPECT_EQ(sut->domain, 0U);
  EXPECT_FALSE(sut->localhost_only);
  EXPECT_TRUE(sut->peers.empty());
  EXPECT_FALSE(sut->server.has_value());
}

TEST(RosDomain, IsThatOfTheEnvironment) {
  const auto sut = domain_of({{"ROS_DOMAIN_ID", "42"},
                              {"RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp"},
                              {"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"},
                              {"ROS_STATIC_PEERS", "192.168.1.7;localhost;"}});
  ASSERT_TRUE(sut.has_value()) << sut.error().message;
  EXPECT_EQ(sut->vendor, link::Vendor::kCycloneDds);
  EXPECT_EQ(sut->domain, 42U);
  EXPECT_FALSE(sut->localhost_only) << "or the peers are out of reach";
  EXPECT_EQ(sut->peers, (std::vector<std::string>{"192.168.1.7", "127.0.0.1"}));
}

TEST(RosDomain, NewerRangeGoesBeforeTheOlderVariable) {
  EXPECT_TRUE(domain_of({{"ROS_LOCALHOST_ONLY", "1"}})->localhost_only);
  EXPECT_TRUE(domain_of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"}})->localhost_only);
  EXPECT_FALSE(domain_of({{"ROS_LOCALHOST_ONLY", "0"}})->localhost_only);
  EXPECT_FALSE(domain_of({{"ROS_LOCALHOST_ONLY", "1"}, {"ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"}})
                   ->localhost_only);
}

TEST(RosDomain, KnowsTheServerOfFastDds) {
  EXPECT_EQ(domain_of({{"ROS_DISCOVERY_SERVER", "10.0.0.1:11811"}})->server, "10.0.0.1:11811");
  EXPECT_EQ(domain_of({{"ROS_DISCOVERY_SERVER", "10.0.0.1"}})->server, "10.0.0.1");
}

TEST(RosDomain, RefusesWhatHasNoMeaningByItsName) {
  const std::map<std::string, Environment> wrong = {
      {"ROS_DOMAIN_ID", {{"ROS_DOMAIN_ID", "233"}}},
      {"ROS_DOMAIN_ID is 'x'", {{"ROS_DOMAIN_ID", "x"}}},
      {"RMW_IMPLEMENTATION", {{"RMW_IMPLEMENTATION", "rmw_zenoh_cpp"}}},
      {"ROS_AUTOMATIC_DISCOVERY_RANGE", {{"ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"}}},
      {"ROS_AUTOMATIC_DISCOVERY_RANGE is 'HERE'", {{"ROS_AUTOMATIC_DISCOVERY_RANGE", "HERE"}}},
      {"ROS_LOCALHOST_ONLY", {{"ROS_LOCALHOST_ONLY", "yes"}}},
      {"ROS_STATIC_PEERS is 'no host'", {{"ROS_STATIC_PEERS", "127.0.0.1;no host"}}},
      {"ROS_DISCOVERY_SERVER", {{"ROS_DISCOVERY_SERVER", "10.0.0.1:99999"}}},
      {"must be one address", {{"ROS_DISCOVERY_SERVER", "10.0.0.1:11811;10.0.0.2:11811"}}},
      {"is one of Fast DDS",
       {{"ROS_DISCOVERY_SERVER", "10.0.0.1"}, {"RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp"}}}};
  for (const auto& [text, set] : wrong) {
    const auto sut = domain_of(set);
    ASSERT_FALSE(sut.has_value()) << text;
    EXPECT_NE(sut.error().message.find(text), std::string::npos) << sut.error().message;
  }
}

}  // namespace
}  // namespace swarm::ros
