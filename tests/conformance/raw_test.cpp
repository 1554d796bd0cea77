// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// Monitors: encoded samples of the launcher and planner of a run and of a replay.
#include <algorithm>
#include <array>
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "swarm_link/cdr/codec.hpp"
#include "swarm_link/monitor_topics.hpp"
#include "swarm_link/roles/join.hpp"
#include "tests/conformance/bus.hpp"

namespace swarm::link::conformance {
namespace {

template <class Condition>
bool eventually(Condition condition) {
  for (int i = 0; i < 3000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

StatusMessage status_of(std::uint32_t robot, std::uint32_t ticks) {
  StatusMessage status{.first_robot_id = robot};
  status.robots.push_back({.robot_id = robot, .ticks = ticks});
  status.refused.assign(robot % 3, 7);
  return status;
}

template <class M>
std::vector<std::byte> bytes_of(const M& message) {
  std::vector<std::byte> bytes;
  EXPECT_TRUE(encode(message, bytes));
  bytes.resize((bytes.size() + 3) / 4 * 4);  // as DDS carries it
  return bytes;
}

MonitorTopic topic_named(const std::string& recorded) {
  const auto topics = monitor_topics();
  return *std::find_if(topics.begin(), topics.end(),
                       [&](const MonitorTopic& topic) { return topic.recorded == recorded; });
}

/// The messages that a reader has received so far, sorted by the time of publication.
std::vector<RawMessage> received(Participant& participant, RawReader& reader,
                                 std::size_t expected) {
  std::vector<RawMessage> messages;
  EXPECT_TRUE(eventually([&] {
    participant.receive();
    reader.take(messages);
    return messages.size() >= expected;
  }));
  std::stable_sort(messages.begin(), messages.end(),
                   [](const auto& a, const auto& b) { return a.sent_utc_ns < b.sent_utc_ns; });
  return messages;
}

TEST(Raw, ReceivesTheLaunchersBytesUnchanged) {
  const Meeting meeting{.domain = test_domain(), .relays = 1};
  const auto launcher = join_as_launcher(meeting).value();
  const auto writer = launcher->make_writer(relayed_status_topic()).value();
  const auto monitor = join_as_monitor(meeting, 10).value();
  const auto reader = monitor->make_reader(topic_named("swarm/status").wire).value();
  ASSERT_TRUE(eventually([&] {
    launcher->receive();
    monitor->receive();
    return writer->matched() == 1 && reader->matched() == 1;
  }));

  std::vector<std::vector<std::byte>> sent;
  for (std::uint32_t ticks = 0; ticks < 3; ++ticks) {
    for (std::uint32_t robot = 0; robot < 20; ++robot) {
      ASSERT_TRUE(writer->write(status_of(robot, ticks)));
      sent.push_back(bytes_of(status_of(robot, ticks)));
    }
  }

  const auto messages = received(*monitor, *reader, sent.size());
  ASSERT_EQ(messages.size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) EXPECT_EQ(messages[i].bytes, sent[i]) << i;
}

TEST(Raw, RepublishesWhatWasReceived) {
  const Meeting meeting{.domain = test_domain(), .relays = 1};
  const auto stage = join_as_replay(meeting).value();
  const auto plans = stage.planner->make_writer(topic_named("swarm/plan").wire).value();
  const auto statuses = stage.launcher->make_writer(topic_named("swarm/status").wire).value();
  const auto monitor = join_as_monitor(meeting, 0).value();
  const auto plan_reader = monitor->make_reader(topic_named("swarm/plan").wire).value();
  const auto status_reader = monitor->make_reader(topic_named("swarm/status").wire).value();
  // Larger than a datagram, and published before a reader exists: it is transient-local.
  PlanMessage plan{.version = 3, .epoch = 4};
  plan.nodes.resize(2000);
  RawMessage message{.bytes = bytes_of(plan)};
  ASSERT_TRUE(plans->write(message.bytes));
  ASSERT_TRUE(eventually([&] {
    monitor->receive();
    stage.launcher->receive();
    stage.planner->receive();
    return statuses->matched() == 1 && status_reader->matched() == 1;
  }));
  RawMessage status{.bytes = bytes_of(status_of(5, 9))};
  ASSERT_TRUE(statuses->write(status.bytes));

  const auto received_status = received(*monitor, *status_reader, 1);
  EXPECT_EQ(received_status.front().bytes, status.bytes);
  std::vector<RawMessage> received_plans;
  EXPECT_TRUE(eventually([&] {
    monitor->receive();
    stage.planner->receive();
    plan_reader->take(received_plans);
    return !received_plans.empty();
  }));
  ASSERT_EQ(received_plans.size(), 1U);
  EXPECT_EQ(received_plans.front().bytes, message.bytes);
}

TEST(Raw, RefusesWhatIsNoSample) {
  const Meeting meeting{.domain = test_domain(), .relays = 1};
  const auto stage = join_as_replay(meeting).value();
  const auto writer = stage.launcher->make_writer(topic_named("swarm/event").wire).value();
  EXPECT_FALSE(writer->write(std::array{std::byte{0}}));
}

}  // namespace
}  // namespace swarm::link::conformance
