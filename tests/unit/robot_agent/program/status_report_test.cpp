// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/program/status_report.hpp"

#include <map>
#include <set>

#include <gtest/gtest.h>

#include "tests/unit/robot_agent/program/process_bench.hpp"

namespace swarm::agent {
namespace {

/// 250 robots, so three messages of at most 100; 10 ticks in a status period.
class StatusReportTest : public ProcessBench {
 protected:
  StatusReportTest() : ProcessBench(250) {}
  StatusReport::Source source() {
    return {
        .robots = robots_, .inbox = sut_, .state_age = ages_, .now = steady(), .utc_now = utc()};
  }
  /// The first robots of the groups that are reported at the next tick.
  std::set<std::uint32_t> tick(Duration later = milliseconds(100)) {
    receive(later);
    report_.on_tick(source());
    std::set<std::uint32_t> groups;
    for (const link::StatusMessage& m : writer_.take()) groups.insert(m.first_robot_id);
    return groups;
  }

  const std::set<std::uint32_t> all_{0, 100, 200};
  KeepingWriter<link::StatusMessage> writer_;
  StatusReport report_{with_rates(), writer_};

 private:
  static Mission with_rates() {
    Mission mission;
    mission.control.rate_hz = 10;
    mission.link.status_hz = 1;
    return mission;
  }
};

TEST_F(StatusReportTest, ReportsEveryRobotOnceInGroupsOfAHundred) {
  report_.publish_all(source());

  ASSERT_EQ(writer_.written.size(), 3U);
  std::uint32_t next = 0;
  for (const link::StatusMessage& m : writer_.written) {
    EXPECT_EQ(m.first_robot_id, next);
    EXPECT_EQ(m.process_id, static_cast<std::uint32_t>(::getpid()));
    EXPECT_EQ(m.stamp_utc_ns, utc_ns());
    for (const link::RobotStatusMessage& robot : m.robots) EXPECT_EQ(robot.robot_id, next++);
  }
  EXPECT_EQ(next, 250U);
}

TEST_F(StatusReportTest, ReportsAllAtItsFirstTickThenEachGroupOnceInAPeriod) {
  EXPECT_EQ(tick(), all_);
  std::map<std::uint32_t, int> reports;
  for (int k = 0; k < 50; ++k) {
    const auto groups = tick();
    EXPECT_LE(groups.size(), 1U);  // in turn
    for (const std::uint32_t group : groups) ++reports[group];
  }

  for (const std::uint32_t group : all_) EXPECT_EQ(reports[group], 5) << group;
}

TEST_F(StatusReportTest, ReportsANewPlanAtOnce) {
  tick();
  send_plan(flow(8), 1);
  EXPECT_EQ(tick(), all_);
  send_plan(flow(8), 2);
  receive();
  report_.on_tick(source());

  ASSERT_EQ(writer_.written.size(), 3U);
  for (const link::StatusMessage& m : writer_.written) {
    EXPECT_EQ(m.plan_version, 2U);
    EXPECT_EQ(m.plan_epoch, kEpoch);
  }
  writer_.take();
  EXPECT_LE(tick().size(), 1U);
}

TEST_F(StatusReportTest, NamesTheNewestCommandAtOnce) {
  while (!tick().empty()) {
  }
  send_command(CommandKind::kStart, utc_ns());
  receive();
  report_.on_tick(source());
  ASSERT_EQ(writer_.written.size(), 3U);
  const std::uint64_t started = writer_.take()[0].command_id;
  EXPECT_EQ(started, sut_.command_id());
  EXPECT_NE(started, 0U);
  send_command(CommandKind::kPause, utc_ns(seconds(60)));  // stale: it is not obeyed
  EXPECT_LE(tick().size(), 1U);
  EXPECT_EQ(sut_.command_id(), started);
}

// The launcher kills a process that is silent for long.
TEST_F(StatusReportTest, ReportsAllAtOnceAfterASleepLongerThanAStatusPeriod) {
  tick();
  while (!tick(milliseconds(1000)).empty()) {
  }
  EXPECT_EQ(tick(milliseconds(1001)), all_);
}

TEST_F(StatusReportTest, ReportsTheGroupOfARobotThatChangesItsModeAtOnce) {
  tick();
  while (!tick().empty()) {
  }
  step(150, MissionPhase::kStopped);
  ASSERT_TRUE(robots_[150].loop.has_updates());
  const auto groups = tick();

  EXPECT_TRUE(groups.contains(100));
}

// Counters of the process are those of no robot: they must not be added up over the groups.
TEST_F(StatusReportTest, HasTheCountersOfTheProcessOnce) {
  ages_.add(70);
  ages_.add(70);
  send_state(8, utc_ns());  // refused: the inbox knows 8 robots
  receive();
  report_.publish_all(source());

  ASSERT_EQ(writer_.written.size(), 3U);
  const link::StatusMessage& first = writer_.written[0];
  ASSERT_EQ(first.refused.size(), link::kRefusalReasons);
  EXPECT_EQ(first.refused[static_cast<std::size_t>(link::RefusalReason::kOutOfRange)], 1U);
  ASSERT_EQ(first.state_age.size(), 1U);
  EXPECT_EQ(first.state_age[0].count, 2U);
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_TRUE(writer_.written[i].refused.empty());
    EXPECT_TRUE(writer_.written[i].state_age.empty());
  }
}

}  // namespace
}  // namespace swarm::agent
