// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "robot_agent/inbox.hpp"
#include "swarm_link/to_message.hpp"

/// An agent's inbox whose messages a test puts in.
namespace swarm::agent {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Messages that arrive at the next take(), and the number of damaged ones so far.
template <class M>
struct Queue {
  std::vector<M> messages;
  std::uint64_t undecodable = 0;
};

template <class M>
class QueueReader final : public link::Reader<M> {
 public:
  explicit QueueReader(Queue<M>& queue) : queue_(queue) {}
  std::size_t take(std::vector<M>& out) override {
    const auto taken = std::exchange(queue_.messages, {});
    out.insert(out.end(), taken.begin(), taken.end());
    return taken.size();
  }
  int matched() const override { return 1; }
  std::uint64_t undecodable() const override { return queue_.undecodable; }

 private:
  Queue<M>& queue_;
};

class QueueChannel final : public link::StateChannel {
 public:
  explicit QueueChannel(Queue<link::CellStatesMessage>& queue) : queue_(queue), reader_(queue) {}
  std::size_t publish(std::span<const link::RobotStateMessage>) override { return 0; }
  void listen_around(std::span<const Vec2>) override {}
  bool receives_at(const Vec2&) const override { return true; }
  std::size_t take(std::vector<link::CellStatesMessage>& out) override { return reader_.take(out); }
  std::uint64_t undecodable() const override { return queue_.undecodable; }

 private:
  Queue<link::CellStatesMessage>& queue_;
  QueueReader<link::CellStatesMessage> reader_;
};

/// A flow from x = 0 to x = `to_x`.
inline FlowPlan flow(double to_x) {
  const auto node = [](double x, double time_s) {
    return PlanNode{Gaussian::from_parameters({x, 5}, 1, 1, 0), MissionTime(time_s), 1.0};
  };
  return FlowPlan::make({node(1, 0), node(to_x, 60)}, {{0, 1, 1.0}}).value();
}

/// The process of robot 3 of 8 in a yard of 20 m by 10 m. Its UTC clock shows 10⁹ s when its steady
/// clock shows 100 s.
class InboxBench : public testing::Test {
 protected:
  static constexpr UtcTime kBegin{seconds(1'000'000'000)};
  static constexpr std::uint64_t kEpoch = 1'000'000'000ULL * 1'000'000'000ULL - 1'000'000'000ULL;

  UtcTime utc() const { return kBegin + since_; }
  SteadyTime steady() const { return SteadyTime(seconds(100)) + since_; }
  std::int64_t utc_ns(Duration ago = {}) const { return (utc() - ago).time_since_epoch().count(); }

  void receive(Duration later = milliseconds(100)) {
    since_ += later;
    sut_.receive(steady(), utc(), [&](RobotId robot) {
      return robot == RobotId(3) ? &own_ : static_cast<const link::EchoGuard*>(nullptr);
    });
  }
  void send_plan(const FlowPlan& plan, std::uint32_t version, std::uint64_t epoch = kEpoch) {
    plans_.messages.push_back(
        link::to_message(plan, PlannerEpoch(epoch), PlanVersion(version), utc()));
  }
  void send_heartbeat(std::uint32_t version, double plan_time_s, std::uint64_t epoch = kEpoch) {
    beats_.messages.push_back({.version = version,
                               .epoch = epoch,
                               .sequence_number = ++beats_sent_,
                               .stamp_utc_ns = utc_ns(-milliseconds(100)),  // at the next tick
                               .plan_time_s = plan_time_s,
                               .plan_rate = 1.0});
  }
  void send_state(std::uint32_t robot, std::int64_t stamp_ns) {
    states_.messages.push_back({.states = {{.robot_id = robot,
                                            .sequence_number = 5,
                                            .stamp_utc_ns = stamp_ns,
                                            .x_m = 4,
                                            .y_m = 5,
                                            .vx_mps = 1}}});
  }
  void send_command(CommandKind kind, std::int64_t stamp_ns) {
    commands_.messages.push_back({.kind = kind,
                                  .command_id = static_cast<std::uint64_t>(stamp_ns),
                                  .stamp_utc_ns = stamp_ns});
  }
  std::vector<ReceivedState> received() const {
    std::vector<ReceivedState> all;
    sut_.received().visit_near({4, 5}, [&](const ReceivedState& s) { all.push_back(s); });
    return all;
  }

  Queue<link::PlanMessage> plans_;
  Queue<link::SceneMessage> scenes_;
  Queue<link::HeartbeatMessage> beats_;
  Queue<link::CommandMessage> commands_;
  Queue<link::CellStatesMessage> states_;
  QueueChannel channel_{states_};
  link::EchoGuard own_;
  std::uint64_t beats_sent_ = 0;
  Duration since_{};
  Inbox sut_{{std::make_unique<QueueReader<link::PlanMessage>>(plans_),
              std::make_unique<QueueReader<link::SceneMessage>>(scenes_),
              std::make_unique<QueueReader<link::HeartbeatMessage>>(beats_),
              std::make_unique<QueueReader<link::CommandMessage>>(commands_)},
             channel_,
             {.robots = 8,
              .bounds_m = {{0, 0}, {20, 10}},
              .clock_skew_warn = milliseconds(200),
              .clock_skew_refuse = seconds(30)},
             MissionWatch(seconds(2)),
             seconds(2),
             4.0};
};

}  // namespace swarm::agent
