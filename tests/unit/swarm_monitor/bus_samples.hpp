// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_link/cdr/codec.hpp"
#include "swarm_link/messages.hpp"
#include "swarm_link/to_message.hpp"
#include "swarm_monitor/recording/bus_tap.hpp"
#include "swarmflow/mission/mission.hpp"

/// Samples of the bus, as a tap hands them over.
namespace swarm::monitor {

/// Second s of a run that began in 2027.
inline UtcTime second(double s) {
  return UtcTime(std::chrono::seconds(1'800'000'000)) + from_seconds(s);
}
inline std::int64_t utc_ns(UtcTime time) { return time.time_since_epoch().count(); }

/// Four robots in a field of 40 x 20 m with one obstacle.
inline Mission four_robots() {
  Mission mission;
  mission.name = "four";
  mission.robots.count = 4;
  mission.world = World::make({{0, 0}, {40, 20}}, {Circle{{20, 10}, 2.0}}).value();
  return mission;
}

/// A plan from (5, 10) to (35, 10) in 30 s.
inline FlowPlan straight_plan() {
  return FlowPlan::make({{.gaussian = Gaussian::from_valid({5, 10}, Mat2::Identity()),
                          .time = MissionTime(0),
                          .mass = 1},
                         {.gaussian = Gaussian::from_valid({35, 10}, Mat2::Identity()),
                          .time = MissionTime(30),
                          .mass = 1}},
                        {{.from = 0, .to = 1, .mass = 1.0}})
      .value();
}

inline std::uint32_t topic_number(const std::string& name) {
  const auto& topics = recorded_topics();
  const auto it = std::find_if(topics.begin(), topics.end(),
                               [&](const RecordedTopic& topic) { return topic.name == name; });
  EXPECT_NE(it, topics.end()) << name;
  return static_cast<std::uint32_t>(it - topics.begin());
}

/// Hands bytes to a reader or a state.
template <class Taker>
void deliver_bytes(Taker& taker, const std::string& topic, UtcTime received,
                   const std::vector<std::byte>& bytes) {
  const auto* const begin = reinterpret_cast<const unsigned char*>(bytes.data());
  taker.take(TappedSample{.topic = topic_number(topic),
                          .received = received,
                          .sent = received,
                          .bytes = {begin, bytes.size()}});
}

/// Hands an encoded message to a reader or a state.
template <class Taker, class M>
void deliver(Taker& taker, const std::string& topic, UtcTime received, const M& message) {
  std::vector<std::byte> bytes;
  ASSERT_TRUE(link::encode(message, bytes));
  deliver_bytes(taker, topic, received, bytes);
}

/// A batch of states of the topic swarm/cell.
inline link::CellStatesMessage batch_of(std::vector<link::RobotStateMessage> states) {
  link::CellStatesMessage batch;
  batch.states = std::move(states);
  return batch;
}

}  // namespace swarm::monitor
