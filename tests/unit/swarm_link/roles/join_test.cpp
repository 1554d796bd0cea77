// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// The numbers and refusals of a meeting, without DDS; meetings of processes are in
// tests/conformance and tests/system.
#include "swarm_link/roles/join.hpp"

#include <set>

#include <gtest/gtest.h>

#include "swarm_link/announcement_port.hpp"
#include "swarm_link/roles/run_meeting.hpp"
#include "swarm_link/udp_socket.hpp"

namespace swarm::link {
namespace {

TEST(RelaysFor, AreAsFewAsHave25AgentsAtMost) {
  for (std::uint32_t agents = 1; agents <= 3'000; ++agents) {
    const std::uint32_t relays = relays_for(agents);
    EXPECT_GE(relays * 25, agents);
    EXPECT_LT((relays - 1) * 25, agents);
  }
  EXPECT_EQ(relays_for(0), 1U) << "launcher and planner meet there";
}

TEST(ParticipantsFor, CountEveryProcessOfARunAndSomeMonitors) {
  constexpr std::uint32_t kGateway = 1;
  for (const std::uint32_t agents : {0U, 1U, 25U, 26U, 300U}) {
    for (const std::uint32_t relays : {0U, 1U, 2U, 12U}) {
      const std::uint32_t of_two = 2 * (relays == 0 ? 1 : relays);  // launcher and planner
      EXPECT_GT(participants_for({.relays = relays}, agents), of_two + kGateway + agents);
    }
  }
}

TEST(AnnouncementPort, IsThatOfTheStandard) {
  // DDSI-RTPS 9.6.1.1: PB + DG · domain + d1 + PG · participant, with PB 7400, DG 250, d1 10, PG 2.
  EXPECT_EQ(announcement_port(0, 0), 7410);
  EXPECT_EQ(announcement_port(0, 1), 7412);
  EXPECT_EQ(announcement_port(1, 0), 7660);
  EXPECT_EQ(announcement_port(229, 119), 64'898);
}

// Two participants at one port would receive each other's announcements.
TEST(AnnouncementPort, IsThatOfOneParticipantAlone) {
  std::set<std::uint16_t> ports;
  for (std::uint32_t domain = 0; domain < 230; ++domain) {
    ports.insert(ntohs(multicast_group(domain, 0).sin_port));
    for (std::uint32_t index = 0; index < 120; ++index) {
      ports.insert(announcement_port(domain, index));
    }
  }
  EXPECT_EQ(ports.size(), 230U * 121U);
}

TEST(Join, RefusesTheDiscoveryServerToCycloneDds) {
  const auto refusal = [](const auto& joined) {
    return joined ? "" : std::string(joined.error().message);
  };
  const std::string reason =
      "cyclonedds: a discovery server of Fast DDS is not for Cyclone DDS; use --channel groups, "
      "whose processes meet without one";
  const auto launcher = join_as_launcher({.launcher = Vendor::kCycloneDds});
  EXPECT_EQ(refusal(launcher), "--dds launcher=" + reason);
  EXPECT_EQ(launcher.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(refusal(join_as_planner({.planner = Vendor::kCycloneDds})), "--dds planner=" + reason);
  EXPECT_EQ(refusal(join_as_agent({}, 0, "robot", Vendor::kCycloneDds)), "--dds " + reason);
}

TEST(MeetingOf, IsThatOfTheRunAndTheFaultsOfTheProcess) {
  const shell::RunInfo run{.domain = 17,
                           .discovery_host = "127.0.0.2",
                           .discovery_port = 4711,
                           .relays = 3,
                           .planner = Vendor::kCycloneDds,
                           .host = "127.0.0.3",
                           .interface = "127.0.0.4"};

  const Meeting meeting = meeting_of(run, {.faults = {.loss = 0.25}, .seed = 5});

  EXPECT_EQ(meeting.domain, 17U);
  EXPECT_EQ(meeting.server.host, "127.0.0.2");
  EXPECT_EQ(meeting.server.port, 4711);
  EXPECT_EQ(meeting.relays, 3U);
  EXPECT_EQ(meeting.launcher, Vendor::kFastDds);
  EXPECT_EQ(meeting.planner, Vendor::kCycloneDds);
  EXPECT_EQ(meeting.host, "127.0.0.3");
  EXPECT_EQ(meeting.interface, "127.0.0.4");
  EXPECT_EQ(meeting.faults.faults.loss, 0.25);
  EXPECT_EQ(meeting.faults.seed, 5U);
  EXPECT_EQ(meeting_of({.launcher = Vendor::kCycloneDds}).launcher, Vendor::kCycloneDds);
}

}  // namespace
}  // namespace swarm::link
