// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "planner_service/program/planner_inbox.hpp"

#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "swarm_link/to_message.hpp"

namespace swarm::planner {
namespace {

using std::chrono::seconds;

constexpr std::uint64_t kFirst = 11, kSecond = 12, kForger = 13;

/// Messages that arrive at the next take(), with their senders.
template <class M>
struct Arriving {
  std::vector<M> messages;
  std::vector<std::uint64_t> senders;
};

template <class M>
class ArrivingReader final : public link::Reader<M> {
 public:
  explicit ArrivingReader(Arriving<M>& arriving) : arriving_(arriving) {}
  std::size_t take(std::vector<M>& out) override {
    std::vector<std::uint64_t> ignored;
    return take_with_senders(out, ignored);
  }
  std::size_t take_with_senders(std::vector<M>& out, std::vector<std::uint64_t>& senders) override {
    const auto taken = std::exchange(arriving_, {});
    out.insert(out.end(), taken.messages.begin(), taken.messages.end());
    senders.insert(senders.end(), taken.senders.begin(), taken.senders.end());
    return taken.messages.size();
  }
  int matched() const override { return 1; }
  std::uint64_t undecodable() const override { return 0; }

 private:
  Arriving<M>& arriving_;
};

class PlannerInboxTest : public testing::Test {
 protected:
  /// Statuses of robot 3 that pass, of one that a sender publishes now.
  std::size_t receive_from(std::uint64_t sender) {
    now_ += seconds(1);
    statuses_.messages.push_back({.first_robot_id = 3,
                                  .stamp_utc_ns = now_.time_since_epoch().count(),
                                  .robots = {{.robot_id = 3}}});
    statuses_.senders.push_back(sender);
    sut_.receive(now_);
    return sut_.statuses().size();
  }
  /// The launcher makes the body of robot 3 an obstacle.
  void fall() {
    link::SceneMessage scene = link::to_message(first_scene(0));
    scene.version = static_cast<std::uint64_t>(now_.time_since_epoch().count());
    scene.obstacles = {{.obstacle_id = 0x8000'0003, .owner_robot_id = 3, .radius_m = 1}};
    scenes_.messages.push_back(scene);
    scenes_.senders.push_back(1);
  }

  UtcTime now_{seconds(1'800'000'000)};
  Arriving<link::CommandMessage> commands_;
  Arriving<link::SceneMessage> scenes_;
  Arriving<link::StatusMessage> statuses_;
  Arriving<link::HeartbeatMessage> beats_;
  PlannerInbox sut_{{std::make_unique<ArrivingReader<link::CommandMessage>>(commands_),
                     std::make_unique<ArrivingReader<link::SceneMessage>>(scenes_),
                     std::make_unique<ArrivingReader<link::StatusMessage>>(statuses_),
                     std::make_unique<ArrivingReader<link::HeartbeatMessage>>(beats_)},
                    {.robots = 8,
                     .bounds_m = {.min_m = {0.0, 0.0}, .max_m = {50.0, 40.0}},
                     .clock_skew_refuse = seconds(10),
                     .status_takeover = seconds(10)}};
};

TEST_F(PlannerInboxTest, TakesStatusesOfARobotFromItsOwnSender) {
  EXPECT_EQ(receive_from(kFirst), 1U);
  EXPECT_EQ(receive_from(kForger), 0U);
  EXPECT_EQ(sut_.refused()[link::RefusalReason::kForged], 1U);
  EXPECT_EQ(receive_from(kFirst), 1U);
}

TEST_F(PlannerInboxTest, FollowsTheNextProcessOfARobotThatFell) {
  EXPECT_EQ(receive_from(kFirst), 1U);
  fall();
  EXPECT_EQ(receive_from(kSecond), 0U) << "published before the planner knew that it fell";
  EXPECT_EQ(receive_from(kSecond), 1U);
  EXPECT_EQ(receive_from(kFirst), 0U);
  EXPECT_EQ(sut_.refused()[link::RefusalReason::kForged], 1U);
}

}  // namespace
}  // namespace swarm::planner
