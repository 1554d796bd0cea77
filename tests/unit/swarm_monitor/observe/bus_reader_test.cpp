// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/observe/bus_reader.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "swarmflow/core/random.hpp"
#include "tests/unit/swarm_monitor/bus_samples.hpp"

namespace swarm::monitor {
namespace {

using link::RefusalReason;

/// Keeps all that is reported.
struct Notes final : Observer {
  void on_plan(const ObservedPlan& plan) override { plans.push_back(plan.version); }
  void on_clock(const ObservedClock& clock) override { clocks.push_back(clock); }
  void on_scene(const Scene& scene) override { scenes.push_back(scene); }
  void on_state(const ObservedState& state) override { states.push_back(state); }
  void on_status(const ObservedStatus& status) override { statuses.push_back(status); }
  void on_event(const ObservedEvent& event) override { events.push_back(event); }
  std::size_t size() const {
    return plans.size() + clocks.size() + scenes.size() + states.size() + statuses.size() +
           events.size();
  }
  std::vector<std::uint32_t> plans;
  std::vector<ObservedClock> clocks;
  std::vector<Scene> scenes;
  std::vector<ObservedState> states;
  std::vector<ObservedStatus> statuses;
  std::vector<ObservedEvent> events;
};

class BusReaderTest : public testing::Test {
 protected:
  link::PlanMessage plan(std::uint64_t epoch, std::uint32_t version) const {
    return link::to_message(straight_plan(), PlannerEpoch(epoch), PlanVersion(version), second(0));
  }
  link::HeartbeatMessage beat(std::uint64_t number) const {
    return {.phase = MissionPhase::kRunning,
            .version = 1,
            .epoch = 1,
            .sequence_number = number,
            .stamp_utc_ns = utc_ns(second(1)),
            .mission_time_s = 12.0,
            .plan_time_s = 10.0,
            .plan_rate = 0.5};
  }

  Notes notes_;
  BusReader reader_{four_robots(), notes_, link::Stamps::kRecorded};
};

TEST_F(BusReaderTest, ReportsAllFieldsOfAState) {
  deliver(reader_, "swarm/cell", second(5.5),
          batch_of({{.robot_id = 2,
                     .sequence_number = 77,
                     .stamp_utc_ns = utc_ns(second(5.25)),
                     .x_m = 1.5,
                     .y_m = 2.5,
                     .vx_mps = -0.5,
                     .vy_mps = 0.25,
                     .mode = RobotMode::kHolding}}));

  ASSERT_EQ(notes_.states.size(), 1U);
  const ObservedState& state = notes_.states[0];
  EXPECT_EQ(state.robot, RobotId(2));
  EXPECT_EQ(state.sequence, 77U);
  EXPECT_EQ(state.stamp, second(5.25));
  EXPECT_EQ(state.received, second(5.5));
  EXPECT_EQ(state.position_m, Vec2(1.5, 2.5));
  EXPECT_EQ(state.velocity_mps, Vec2(-0.5, 0.25));
  EXPECT_EQ(state.mode, RobotMode::kHolding);
  EXPECT_EQ(reader_.refused().total(), 0U);
}

TEST_F(BusReaderTest, TakesStatesOfAnyAgeAndNoneOfTheFuture) {
  // A replay of a recording is years old; a stamp of tomorrow is wrong whatever is played.
  const UtcTime now = second(5);
  for (const UtcTime stamp : {UtcTime{}, now - std::chrono::hours(24 * 365), now,
                              now + std::chrono::seconds(9), now + std::chrono::seconds(11)}) {
    deliver(reader_, "swarm/cell", now,
            batch_of({{.robot_id = 0, .stamp_utc_ns = utc_ns(stamp), .x_m = 1, .y_m = 1}}));
  }

  EXPECT_EQ(notes_.states.size(), 4U);
  EXPECT_EQ(reader_.refused()[RefusalReason::kClockSkew], 1U);
  EXPECT_EQ(reader_.refused().total(), 1U);
}

TEST_F(BusReaderTest, RefusesABadStateWithoutTheOthersOfItsBatch) {
  const auto state = [](std::uint32_t robot, double x_m) {
    return link::RobotStateMessage{
        .robot_id = robot, .stamp_utc_ns = utc_ns(second(5)), .x_m = x_m, .y_m = 1};
  };
  deliver(reader_, "swarm/cell", second(5),
          batch_of({state(0, 1), state(1, std::nan("")), state(9, 1), state(3, 1e6), state(2, 1)}));

  ASSERT_EQ(notes_.states.size(), 2U);
  EXPECT_EQ(notes_.states[0].robot, RobotId(0));
  EXPECT_EQ(notes_.states[1].robot, RobotId(2));
  EXPECT_EQ(reader_.refused()[RefusalReason::kNotFinite], 1U);
  EXPECT_EQ(reader_.refused()[RefusalReason::kOutOfRange], 2U);
}

TEST_F(BusReaderTest, ReportsAllFieldsOfAStatus) {
  link::StatusMessage message;
  message.robots = {{.robot_id = 1,
                     .mode = RobotMode::kMoving,
                     .arrived = true,
                     .x_m = 3,
                     .y_m = 4,
                     .remaining_m = 5,
                     .lag_s = -0.5,
                     .nearest_gap_m = 0.75,
                     .neighbours_heard = 6,
                     .ticks = 700,
                     .late_ticks = 8},
                    {.robot_id = 3, .nearest_gap_m = 1e9}};
  deliver(reader_, "swarm/status", second(2), message);

  ASSERT_EQ(notes_.statuses.size(), 2U);
  const ObservedStatus& status = notes_.statuses[0];
  EXPECT_EQ(status.robot, RobotId(1));
  EXPECT_EQ(status.received, second(2));
  EXPECT_EQ(status.position_m, Vec2(3, 4));
  EXPECT_EQ(status.mode, RobotMode::kMoving);
  EXPECT_TRUE(status.arrived);
  EXPECT_EQ(status.remaining_m, 5.0);
  EXPECT_EQ(status.lag_s, -0.5);
  EXPECT_EQ(status.nearest_gap_m, 0.75);
  EXPECT_EQ(status.neighbours, 6U);
  EXPECT_EQ(status.ticks, 700U);
  EXPECT_EQ(status.late_ticks, 8U);
  // The wire has no infinity: a gap larger than any map stands for it.
  EXPECT_EQ(notes_.statuses[1].nearest_gap_m, std::numeric_limits<double>::infinity());
}

TEST_F(BusReaderTest, ReportsPlansInTheirOrder) {
  for (const auto& [epoch, version] :
       {std::pair{5, 1}, {5, 2}, {5, 2}, {5, 1}, {4, 9}, {6, 1}, {5, 3}}) {
    deliver(reader_, "swarm/plan", second(3),
            plan(static_cast<std::uint64_t>(epoch), static_cast<std::uint32_t>(version)));
  }

  // A planner that takes over has a higher epoch, so its version 1 counts.
  EXPECT_EQ(notes_.plans, (std::vector<std::uint32_t>{1, 2, 1}));
  EXPECT_EQ(reader_.refused()[RefusalReason::kDuplicate], 1U);
  EXPECT_EQ(reader_.refused()[RefusalReason::kStale], 3U);
}

// As the robots do: a planner that beats leads, and another one with its plan only after a silence.
TEST_F(BusReaderTest, OfARunInProgressFollowsTheRulingPlanner) {
  BusReader live(four_robots(), notes_, link::Stamps::kLive);
  const auto beat_of = [&](std::uint64_t epoch, std::uint64_t number, double at_s) {
    auto message = beat(number);
    message.epoch = epoch;
    message.mission_time_s = static_cast<double>(epoch);
    message.stamp_utc_ns = utc_ns(second(at_s));
    deliver(live, "swarm/heartbeat", second(at_s), message);
  };
  beat_of(5, 1, 10.0);
  deliver(live, "swarm/plan", second(10.0), plan(5, 1));
  deliver(live, "swarm/plan", second(10.1), plan(6, 2));
  beat_of(6, 1, 10.1);
  beat_of(5, 2, 10.2);
  EXPECT_EQ(notes_.plans, (std::vector<std::uint32_t>{1}));
  ASSERT_EQ(notes_.clocks.size(), 2U);
  EXPECT_EQ(notes_.clocks[1].mission_time_s, 5.0);
  EXPECT_EQ(live.refused()[RefusalReason::kStale], 2U);

  beat_of(6, 2, 15.0);
  EXPECT_EQ(notes_.plans, (std::vector<std::uint32_t>{1, 2}));
  ASSERT_EQ(notes_.clocks.size(), 3U);
  EXPECT_EQ(notes_.clocks[2].mission_time_s, 6.0);
}

TEST_F(BusReaderTest, ReportsAClockAndNoOlderOne) {
  for (const std::uint64_t number : {4U, 3U, 5U}) {
    deliver(reader_, "swarm/heartbeat", second(1.5), beat(number));
  }

  ASSERT_EQ(notes_.clocks.size(), 2U);
  EXPECT_EQ(notes_.clocks[0].phase, MissionPhase::kRunning);
  EXPECT_EQ(notes_.clocks[0].mission_time_s, 12.0);
  EXPECT_EQ(notes_.clocks[0].plan_time_s, 10.0);
  EXPECT_EQ(notes_.clocks[0].plan_rate, 0.5);
  EXPECT_EQ(notes_.clocks[0].received, second(1.5));
  EXPECT_EQ(reader_.refused()[RefusalReason::kStale], 1U);
}

TEST_F(BusReaderTest, ReportsScenesButNotThatOfTheMissionFile) {
  const Mission mission = four_robots();
  const Scene first = first_scene(mission.world.obstacles().size());
  const auto moved =
      after(first, MoveObstacle{.obstacle = 0, .by_m = {1, 2}}, mission.world, second(2));
  ASSERT_TRUE(moved.has_value());
  deliver(reader_, "swarm/scene", second(2), link::to_message(first));
  EXPECT_TRUE(notes_.scenes.empty());
  EXPECT_EQ(reader_.refused().total(), 0U);

  deliver(reader_, "swarm/scene", second(2), link::to_message(*moved));

  ASSERT_EQ(notes_.scenes.size(), 1U);
  EXPECT_EQ(notes_.scenes[0].version, moved->version);
  ASSERT_EQ(notes_.scenes[0].obstacles.size(), 1U);
  const World world = world_at(mission.world, notes_.scenes[0], second(3));
  EXPECT_EQ(std::get<Circle>(world.obstacles()[0]).center_m, Vec2(21, 12));
}

TEST_F(BusReaderTest, ReportsEventsWithTheNamesOfTheEventLog) {
  const auto event = [](std::uint32_t source, link::Severity severity) {
    return link::EventMessage{
        .severity = severity, .source = source, .code = "robot-fault", .text = "it failed"};
  };
  deliver(reader_, "swarm/event", second(4), event(link::kPlannerSource, link::Severity::kInfo));
  deliver(reader_, "swarm/event", second(4), event(link::kLauncherSource, link::Severity::kError));
  deliver(reader_, "swarm/event", second(4), event(3, link::Severity::kWarning));
  deliver(reader_, "swarm/event", second(4), event(4, link::Severity::kWarning));  // no such robot

  ASSERT_EQ(notes_.events.size(), 3U);
  EXPECT_EQ(notes_.events[0].source, "planner");
  EXPECT_EQ(notes_.events[0].severity, "info");
  EXPECT_EQ(notes_.events[1].source, "launcher");
  EXPECT_EQ(notes_.events[1].severity, "error");
  EXPECT_EQ(notes_.events[2].source, "robot-3");
  EXPECT_EQ(notes_.events[2].severity, "warning");
  EXPECT_EQ(notes_.events[2].code, "robot-fault");
  EXPECT_EQ(notes_.events[2].text, "it failed");
  EXPECT_EQ(reader_.refused().total(), 1U);
}

TEST_F(BusReaderTest, ChecksCommandsAndReportsNone) {
  link::CommandMessage command{.kind = CommandKind::kPause, .command_id = 9, .stamp_utc_ns = 9};
  deliver(reader_, "swarm/command", second(4), command);
  EXPECT_EQ(reader_.refused().total(), 0U);
  deliver(reader_, "swarm/command", second(4), command);

  EXPECT_EQ(reader_.refused()[RefusalReason::kDuplicate], 1U);
  EXPECT_EQ(notes_.size(), 0U);
}

TEST_F(BusReaderTest, CountsEverySampleThatIsNoMessage) {
  const std::vector<std::byte> rubbish(3, std::byte{7});
  const std::vector<std::string> topics{"swarm/cell",     "swarm/status", "swarm/plan",
                                        "swarm/scene",    "swarm/event",  "swarm/command",
                                        "swarm/heartbeat"};
  for (const std::string& topic : topics) deliver_bytes(reader_, topic, second(1), rubbish);
  // Records of robot logs are not checked here: a replay publishes them for Foxglove.
  deliver_bytes(reader_, "blackbox/step", second(1), rubbish);

  EXPECT_EQ(notes_.size(), 0U);
  EXPECT_EQ(reader_.refused()[RefusalReason::kUndecodable], topics.size());
  EXPECT_EQ(reader_.refused().total(), topics.size());
}

TEST_F(BusReaderTest, TakesCutAndChangedMessages) {
  std::vector<std::byte> good;
  ASSERT_TRUE(link::encode(plan(5, 1), good));
  Rng rng(3);
  std::uint64_t samples = 0;
  for (std::size_t size = 0; size < good.size(); ++size, ++samples) {
    deliver_bytes(reader_, "swarm/plan", second(1),
                  {good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)});
  }
  EXPECT_EQ(reader_.refused().total(), samples) << "a cut plan is no plan";
  for (int round = 0; round < 2000; ++round, ++samples) {
    std::vector<std::byte> changed = good;
    for (int k = 0; k < 3; ++k) changed[rng() % changed.size()] = static_cast<std::byte>(rng());
    deliver_bytes(reader_, "swarm/plan", second(1), changed);
  }

  // Each was either reported or counted, never both and never lost.
  EXPECT_EQ(reader_.refused().total() + notes_.plans.size(), samples);
}

}  // namespace
}  // namespace swarm::monitor
