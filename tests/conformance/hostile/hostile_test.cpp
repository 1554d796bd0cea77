// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Samples from a peer that violates the contract are refused or counted and never cause a crash,
// and the next valid sample is received.
#include <gtest/gtest.h>

#include "swarm_link/gate/content_checks.hpp"
#include "tests/conformance/bus.hpp"
#include "tests/conformance/hostile/hostile_writer.hpp"

namespace swarm::link::conformance {
namespace {

struct HostilePeers : testing::Test {
  // Sends until it arrives: as a message, which is returned, or as one more undecodable sample.
  template <class M, class Send>
  std::vector<M> provoke(const ReaderPtr<M>& reader, Send send) {
    const auto before = reader->undecodable();
    EXPECT_TRUE(bus->eventually(send));
    std::vector<M> received;
    EXPECT_TRUE(bus->eventually(
        [&] { return reader->take(received) > 0 || reader->undecodable() > before; }));
    return received;
  }

  template <class M>
  void expect_good_samples_still_pass(const Topic<M>& topic, const ReaderPtr<M>& reader) {
    auto& friendly = bus->participant();
    const auto writer = friendly.make_writer(topic).value();
    ASSERT_TRUE(bus->eventually([&] { return writer->matched() > 0; }));
    std::vector<M> received;
    ASSERT_TRUE(bus->eventually([&] {
      writer->write(M{});
      return reader->take(received) > 0;
    }));
    EXPECT_EQ(received.back(), M{});
  }

  std::unique_ptr<DiscoveryServer> server = make_discovery_server(test_domain(), 0).value();
  std::unique_ptr<Bus> bus = join_fastdds_bus(server->address(), 0);
  Participant& us = bus->participant();
  HostilePeer peer{test_domain(), server->address()};
  WireLimits limits{.robots = 10, .bounds_m = {.min_m = {0, 0}, .max_m = {10, 10}}};
};

TEST_F(HostilePeers, SendBatchesThatAreTooLong) {
  const auto reader = us.make_reader(cell_topic({0, 0})).value();
  for (const std::size_t states : {257, 1'000, 20'000}) {  // the last spans 17 datagrams
    const auto received = provoke(reader, [&] { return peer.send_batch(states); });
    for (const auto& batch : received) {
      EXPECT_EQ(batch.states.size(), states);
      EXPECT_EQ(check_batch(batch).error(), RefusalReason::kOversized);
    }
  }
  expect_good_samples_still_pass(cell_topic({0, 0}), reader);
}

TEST_F(HostilePeers, SendPlansThatAreTooLong) {
  const auto reader = us.make_reader(plan_topic()).value();
  for (const auto& [nodes, legs] : {std::pair{4'097, 0}, {0, 8'193}, {20'000, 20'000}}) {
    const auto received = provoke(reader, [&] {
      return peer.send_plan(static_cast<std::size_t>(nodes), static_cast<std::size_t>(legs));
    });
    for (const auto& plan : received) {
      EXPECT_EQ(check_plan(plan, limits).error(), RefusalReason::kOversized);
    }
  }
  expect_good_samples_still_pass(plan_topic(), reader);
}

TEST_F(HostilePeers, SendTextsThatAreTooLong) {
  const auto reader = us.make_reader(event_topic()).value();
  const auto received = provoke(reader, [&] { return peer.send_event(1'000, 50'000); });
  for (const auto& event : received) {
    EXPECT_LE(event.code.size(), 64U);
    EXPECT_LE(event.text.size(), 512U);
  }
  expect_good_samples_still_pass(event_topic(), reader);
}

TEST_F(HostilePeers, ClaimStatesTheyDoNotSend) {
  const auto reader = us.make_reader(cell_topic({0, 0})).value();
  for (const std::uint32_t count : {1U, 256U, 0x7FFF'FFFFU, 0xFFFF'FFFFU}) {
    EXPECT_TRUE(provoke(reader, [&] { return peer.send_lying_batch(count); }).empty());
  }
  EXPECT_EQ(reader->undecodable(), 4U);
  expect_good_samples_still_pass(cell_topic({0, 0}), reader);
}

TEST_F(HostilePeers, ClaimNodesAndLegsTheyDoNotSend) {
  const auto reader = us.make_reader(plan_topic()).value();
  constexpr std::uint32_t kMany = 0xFFFF'FFFF;
  for (const auto& [nodes, legs, entries] : {std::tuple{1U, 0U, 0U},
                                             {kMany, 0U, 0U},
                                             {0U, 1U, 0U},
                                             {0U, kMany, 0U},
                                             {0U, 0U, 1U},
                                             {0U, 0U, kMany}}) {
    EXPECT_TRUE(
        provoke(reader, [&] { return peer.send_lying_plan(nodes, legs, entries); }).empty());
  }
  EXPECT_EQ(reader->undecodable(), 6U);
  expect_good_samples_still_pass(plan_topic(), reader);
}

TEST_F(HostilePeers, ClaimASceneTheyDoNotSend) {
  const auto reader = us.make_reader(scene_topic()).value();
  for (std::size_t lie = 0; lie < 4; ++lie) {
    std::array<std::uint32_t, 4> counts{};
    counts[lie] = 0xFFFF'FFFF;
    EXPECT_TRUE(provoke(reader, [&] {
                  return peer.send_lying_scene(counts[0], counts[1], counts[2], counts[3]);
                }).empty());
  }
  EXPECT_EQ(reader->undecodable(), 4U);
  expect_good_samples_still_pass(scene_topic(), reader);
}

TEST_F(HostilePeers, ClaimBinsTheyDoNotSendAndFlagsThatAreNone) {
  constexpr std::uint32_t kMany = 0xFFFF'FFFF;
  const auto reader = us.make_reader(status_topic()).value();
  EXPECT_TRUE(provoke(reader, [&] { return peer.send_lying_status(1, 0, kMany, 0); }).empty());
  EXPECT_TRUE(provoke(reader, [&] { return peer.send_lying_status(1, 0, 0, kMany); }).empty());
  EXPECT_TRUE(provoke(reader, [&] { return peer.send_lying_status(1, 2, 0, 0); }).empty());
  EXPECT_TRUE(provoke(reader, [&] { return peer.send_lying_status(kMany, 0, 0, 0); }).empty());
  EXPECT_EQ(reader->undecodable(), 4U);
  EXPECT_EQ(provoke(reader, [&] { return peer.send_lying_status(1, 1, 0, 0); }).size(), 1U);
  expect_good_samples_still_pass(status_topic(), reader);
}

TEST_F(HostilePeers, ClaimTextTheyDoNotSend) {
  const auto reader = us.make_reader(event_topic()).value();
  for (const std::uint32_t code : {5U, 0xFFFF'FFFFU}) {
    EXPECT_TRUE(provoke(reader, [&] { return peer.send_lying_event(code); }).empty());
  }
  EXPECT_EQ(reader->undecodable(), 2U);
  expect_good_samples_still_pass(event_topic(), reader);
}

TEST_F(HostilePeers, SendSamplesThatAreTooShort) {
  const auto heartbeats = us.make_reader(heartbeat_topic()).value();
  EXPECT_TRUE(provoke(heartbeats, [&] { return peer.send_stub_heartbeat(); }).empty());
  expect_good_samples_still_pass(heartbeat_topic(), heartbeats);
  const auto commands = us.make_reader(command_topic()).value();
  EXPECT_TRUE(provoke(commands, [&] { return peer.send_stub_command(); }).empty());
  expect_good_samples_still_pass(command_topic(), commands);
}

}  // namespace
}  // namespace swarm::link::conformance
