// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/inbox.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "swarm_core/base/stamp.hpp"
#include "tests/unit/robot_agent/inbox_bench.hpp"

namespace swarm::agent {
namespace {

using InboxTest = InboxBench;

TEST_F(InboxTest, HandsOutTheNewestPlanOnce) {
  EXPECT_FALSE(sut_.take_plan().has_value());
  send_plan(flow(8), 1);
  send_plan(flow(9), 2);
  receive();

  const auto plan = sut_.take_plan();

  ASSERT_TRUE(plan.has_value());
  EXPECT_EQ(plan->flow.digest(), flow(9).digest());
  EXPECT_EQ(sut_.plan_version(), 2U);
  EXPECT_EQ(sut_.plan_epoch(), kEpoch);
  EXPECT_FALSE(sut_.take_plan().has_value());
  receive();
  EXPECT_FALSE(sut_.take_plan().has_value());
}

TEST_F(InboxTest, KeepsTheLastGoodPlanWhenABadOneArrives) {
  send_plan(flow(8), 1);
  auto bad = link::to_message(flow(9), PlannerEpoch(kEpoch), PlanVersion(2), utc());
  bad.nodes[1].mass = std::numeric_limits<double>::quiet_NaN();
  plans_.messages.push_back(bad);
  send_plan(flow(9), 1);                                 // a duplicate
  send_plan(flow(9), 1, kEpoch - 1);                     // of a predecessor
  send_plan(flow(9), 1, kEpoch + 3'600'000'000'000ULL);  // from the future
  receive();

  EXPECT_EQ(sut_.take_plan().value().flow.digest(), flow(8).digest());
  EXPECT_EQ(sut_.plan_version(), 1U);
  EXPECT_EQ(sut_.refused().total(), 4U);
}

TEST_F(InboxTest, ReadsWhereARobotEntersThePlan) {
  auto message = link::to_message(flow(8), PlannerEpoch(kEpoch), PlanVersion(1), utc());
  message.entries.assign(8, {.source = link::kAnySource, .share = 0});
  message.entries[3] = {.source = 0, .share = 49152};
  plans_.messages.push_back(message);
  receive();

  const auto plan = sut_.take_plan();

  ASSERT_TRUE(plan.has_value());
  const auto entry = plan->entry_of(RobotId(3));
  ASSERT_TRUE(entry.has_value());
  EXPECT_EQ(entry->source, 0U);
  EXPECT_EQ(entry->share, 0.75);
  EXPECT_FALSE(plan->entry_of(RobotId(2)).has_value());  // anywhere
  EXPECT_FALSE(plan->entry_of(RobotId(8)).has_value());  // not in the list
}

TEST_F(InboxTest, KeepsThePlanTimeOfTheSameFlowUnderAnotherVersion) {
  send_plan(flow(8), 1);
  send_heartbeat(1, 20.0);
  receive();
  ASSERT_NEAR(sut_.plan_time(steady()).value().plan_time_s, 20.0, 1e-6);
  send_plan(flow(8), 2);
  receive();

  EXPECT_NEAR(sut_.plan_time(steady()).value().plan_time_s, 20.1, 1e-6);
}

// A planner that is restarted plans again from where the robots are, and numbers from 1.
TEST_F(InboxTest, StartsThePlanTimeOverWithAnotherFlow) {
  send_plan(flow(8), 1);
  send_heartbeat(1, 20.0);
  receive();
  ASSERT_TRUE(sut_.plan_time(steady()).has_value());
  send_plan(flow(9), 1, kEpoch + 1);
  receive();
  EXPECT_FALSE(sut_.plan_time(steady()).has_value());
  send_heartbeat(1, 0.3, kEpoch + 1);
  receive();

  EXPECT_NEAR(sut_.plan_time(steady()).value().plan_time_s, 0.3, 1e-6);
}

TEST_F(InboxTest, HandsOutEachSceneOnceAndNotThatOfTheMissionFile) {
  Scene scene;
  scenes_.messages.push_back(link::to_message(scene));
  receive();
  EXPECT_FALSE(sut_.take_scene().has_value());
  scene.version = static_cast<std::uint64_t>(utc_ns());
  scene.risk_alpha = 0.2;
  scenes_.messages.push_back(link::to_message(scene));
  receive();

  const auto taken = sut_.take_scene();

  ASSERT_TRUE(taken.has_value());
  EXPECT_EQ(taken->version, scene.version);
  EXPECT_EQ(taken->risk_alpha, 0.2);
  EXPECT_FALSE(sut_.take_scene().has_value());
}

TEST_F(InboxTest, KeepsTheStampOfTheFirstStop) {
  send_command(CommandKind::kStart, utc_ns());
  receive();
  EXPECT_EQ(sut_.mission().phase(), MissionPhase::kRunning);
  EXPECT_EQ(sut_.stop_stamp_utc_ns(), 0);
  const std::int64_t first_ns = utc_ns();
  send_command(CommandKind::kStop, first_ns);
  receive();
  send_command(CommandKind::kStop, utc_ns());
  receive();

  EXPECT_EQ(sut_.mission().phase(), MissionPhase::kStopped);
  EXPECT_EQ(sut_.stop_stamp_utc_ns(), first_ns);
}

// The log measures from it how long a stop takes: the difference must fit in 64 bits.
TEST_F(InboxTest, LimitsTheStampOfAStopWithAnyStamp) {
  send_command(CommandKind::kStop, std::numeric_limits<std::int64_t>::min());
  receive();

  EXPECT_EQ(sut_.mission().phase(), MissionPhase::kStopped);
  EXPECT_EQ(sut_.stop_stamp_utc_ns(), -kStampLimit_ns);
}

TEST_F(InboxTest, TakesTheAgeOfAStateFromItsStamp) {
  receive();
  struct Case {
    Duration age, expected;  // the last tick was 100 ms ago
    bool skewed;
  };
  const Case cases[] = {{milliseconds(0), milliseconds(0), false},
                        {milliseconds(30), milliseconds(30), false},
                        {milliseconds(1099), milliseconds(1099), false},  // late in the network
                        {milliseconds(1101), milliseconds(100), true},    // by a clock that is off
                        {-milliseconds(199), milliseconds(0), false},
                        {-milliseconds(201), milliseconds(100), true}};
  std::uint32_t skewed = 0;
  for (const auto& [age, expected, is_skewed] : cases) {
    send_state(1, (utc() + milliseconds(100) - age).time_since_epoch().count());
    receive();

    ASSERT_EQ(received().size(), 1U) << age.count();
    EXPECT_EQ(received()[0].age, expected) << age.count();
    EXPECT_EQ(received()[0].report.as_of, steady() - expected);
    EXPECT_EQ(received()[0].report.velocity_mps, Vec2(1, 0));
    skewed += is_skewed ? 1 : 0;
    EXPECT_EQ(sut_.skewed(), skewed) << age.count();
  }
}

// After a tick that took long, a state may have waited in the socket for all of it.
TEST_F(InboxTest, AllowsForTheTimeSinceItsLastTick) {
  receive();
  send_state(1, utc_ns(milliseconds(500)));
  receive(seconds(5));

  ASSERT_EQ(received().size(), 1U);
  EXPECT_EQ(received()[0].age, milliseconds(5500));
  EXPECT_EQ(sut_.skewed(), 0U);
}

TEST_F(InboxTest, AcceptsUnderItsOwnIdOnlyWhatItPublished) {
  const std::int64_t stamp_ns = utc_ns();
  own_.record_sent({.robot_id = 3, .sequence_number = 5, .stamp_utc_ns = stamp_ns});
  send_state(3, stamp_ns);
  receive();
  EXPECT_EQ(received().size(), 1U);
  send_state(3, stamp_ns + 1);
  send_state(8, stamp_ns);  // no such robot
  receive();

  EXPECT_TRUE(received().empty());
  EXPECT_EQ(sut_.refused()[link::RefusalReason::kForged], 1U);
  EXPECT_EQ(sut_.refused()[link::RefusalReason::kOutOfRange], 1U);
}

TEST_F(InboxTest, CountsDamagedSamplesOfAllItsReaders) {
  plans_.undecodable = 1;
  scenes_.undecodable = 2;
  beats_.undecodable = 4;
  commands_.undecodable = 8;
  states_.undecodable = 16;
  receive();
  EXPECT_EQ(sut_.refused()[link::RefusalReason::kUndecodable], 31U);
  states_.undecodable = 17;
  receive();

  EXPECT_EQ(sut_.refused()[link::RefusalReason::kUndecodable], 32U);
}

TEST_F(InboxTest, NamesAnIdOfItsOwnThatAnotherProcessUses) {
  receive();
  send_state(3, utc_ns(-milliseconds(50)));
  receive();
  EXPECT_EQ(sut_.duplicate_id(), RobotId(3));
}

TEST_F(InboxTest, DoesNotTakeStatesOfItsPredecessorOrItsEchoesForADuplicate) {
  receive();
  send_state(3, utc_ns(milliseconds(200)));  // published before this process began
  receive();
  EXPECT_FALSE(sut_.duplicate_id());

  const link::RobotStateMessage sent{
      .robot_id = 3, .sequence_number = 5, .stamp_utc_ns = utc_ns(-milliseconds(50))};
  own_.record_sent(sent);
  send_state(3, sent.stamp_utc_ns);
  send_state(4, utc_ns());
  receive();
  EXPECT_FALSE(sut_.duplicate_id());
}

}  // namespace
}  // namespace swarm::agent
