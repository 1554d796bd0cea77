// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Two sets of robots, with states by groups and by topics, and the gateway between them.
#include "swarm_link/gateway/gateway.hpp"

#include <functional>
#include <thread>

#include <gtest/gtest.h>

#include "swarm_core/base/clock.hpp"
#include "swarm_link/channels/groups/group_channel.hpp"
#include "swarm_link/roles/join.hpp"
#include "tests/conformance/bus.hpp"

namespace swarm::link::conformance {
namespace {

constexpr double kTopicCell_m = 100.0;

WireLimits limits() {
  return {.robots = 10,
          .bounds_m = {{0, 0}, {150, 50}},
          .clock_skew_warn = std::chrono::seconds(1),
          .clock_skew_refuse = std::chrono::seconds(5)};
}

RobotStateMessage state(std::uint32_t robot, double x_m) {
  return {.robot_id = robot,
          .sequence_number = 1,
          .stamp_utc_ns = utc_now().time_since_epoch().count(),
          .x_m = x_m,
          .y_m = 20};
}

struct GatewayRun : testing::TestWithParam<Vendor> {
  GatewayRun() {
    GroupChannelOptions options{.domain = test_domain()};
    groups = make_group_channel(options).value();
    groups->listen_around(std::vector<Vec2>{{10, 20}, {120, 20}});
  }

  void start_other() {
    other = join_as_agent(meeting, 0, "other", GetParam(), true).value();
    topics = make_topic_channel(*other, {.cell_size_m = kTopicCell_m});
    topics->listen_around(std::vector<Vec2>{{10, 20}, {120, 20}});
  }

  bool eventually(const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (std::chrono::steady_clock::now() < deadline) {
      gateway->relay(std::chrono::milliseconds(2), utc_now());
      if (other) other->receive();
      groups->take(by_groups);
      if (topics) topics->take(by_topics);
      if (condition()) return true;
    }
    return false;
  }

  static std::size_t count(const std::vector<CellStatesMessage>& batches, std::uint32_t robot) {
    std::size_t found = 0;
    for (const auto& batch : batches) {
      for (const auto& s : batch.states) found += s.robot_id == robot ? 1 : 0;
    }
    return found;
  }

  Meeting meeting{.domain = test_domain(), .relays = 1};
  std::unique_ptr<Participant> launcher = join_as_launcher(meeting).value();
  std::unique_ptr<Participant> planner = join_as_planner(meeting).value();
  std::unique_ptr<Participant> relay = join_as_gateway(meeting).value();
  std::unique_ptr<Gateway> gateway =
      make_gateway(*relay,
                   {.domain = test_domain(), .topic_cell_size_m = kTopicCell_m, .limits = limits()})
          .value();
  std::unique_ptr<StateChannel> groups;
  std::unique_ptr<Participant> other;
  std::unique_ptr<StateChannel> topics;
  std::vector<CellStatesMessage> by_groups, by_topics;
};

INSTANTIATE_TEST_SUITE_P(Others, GatewayRun, testing::Values(Vendor::kFastDds, Vendor::kCycloneDds),
                         [](const auto& vendor) {
                           return vendor.param == Vendor::kFastDds ? "FastDds" : "CycloneDds";
                         });

TEST_P(GatewayRun, CarriesStatesBothWaysAndEachOnce) {
  start_other();
  ASSERT_TRUE(eventually([&] { return gateway->in_use(); }));

  // Best effort, and the other process may still be joining: published again until it is received.
  ASSERT_TRUE(eventually([&] {
    groups->publish(std::vector{state(1, 10), state(2, 120)});
    return count(by_topics, 1) > 0 && count(by_topics, 2) > 0;
  }));
  ASSERT_TRUE(eventually([&] {
    topics->publish(std::vector{state(3, 10)});
    return count(by_groups, 3) > 0;
  }));
  constexpr std::chrono::seconds kRecent{2};
  EXPECT_EQ(gateway->robots_by_topics(utc_now(), kRecent), 1U) << "3, and not those of groups";
  EXPECT_EQ(gateway->robots_by_topics(utc_now() + 2 * kRecent, kRecent), 0U);

  eventually([n = 0]() mutable { return ++n > 50; });  // what is under way comes
  by_topics.clear();
  by_groups.clear();
  const auto once = state(4, 11);
  groups->publish(std::vector{once});
  ASSERT_TRUE(eventually([&] { return count(by_topics, 4) > 0; }));
  eventually([n = 0]() mutable { return ++n > 50; });
  EXPECT_EQ(count(by_topics, 4), 1U);
  EXPECT_EQ(count(by_groups, 4), 1U) << "only what was published, no echo";
  const RefusalCounters& refused = gateway->refused();
  EXPECT_EQ(refused.total(), refused[RefusalReason::kDuplicate] + refused[RefusalReason::kStale])
      << "nothing but echoes";
}

TEST_P(GatewayRun, RefusesWhatAnAgentWouldRefuse) {
  start_other();
  ASSERT_TRUE(eventually([&] { return gateway->in_use(); }));

  ASSERT_TRUE(eventually([&] {
    topics->publish(std::vector{state(99, 10)});
    return gateway->refused()[RefusalReason::kOutOfRange] > 0;
  }));
  EXPECT_EQ(count(by_groups, 99), 0U);
}

TEST_P(GatewayRun, DoesNothingWithoutReaders) {
  for (int i = 0; i < 100; ++i) {
    groups->publish(std::vector{state(1, 10)});
    gateway->relay(std::chrono::milliseconds(1), utc_now());
  }

  EXPECT_FALSE(gateway->in_use());
  EXPECT_EQ(gateway->to_topics(), 0U);
}

TEST(Gateway, RefusesAMapOfTooManyCells) {
  const Meeting meeting{.domain = test_domain(), .relays = 1};
  const auto relay = join_as_gateway(meeting).value();

  const auto made =
      make_gateway(*relay, {.domain = test_domain(), .topic_cell_size_m = 5.0, .limits = limits()});

  ASSERT_FALSE(made);
  EXPECT_NE(made.error().message.find("link.cell_size_m"), std::string::npos);
}

}  // namespace
}  // namespace swarm::link::conformance
