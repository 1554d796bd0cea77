// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/loop/robot_loop.hpp"

#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "robot_agent/drivers/simulated_robot.hpp"
#include "robot_agent/loop/status_cadence.hpp"
#include "robot_agent/loop/tick_phase.hpp"

namespace swarm::agent {
namespace {

constexpr Duration kPeriod = std::chrono::milliseconds(100);

struct MemoryLog final : RobotLog {
  void append(const robot_log::Step& step) override { steps.push_back(step); }
  void append(const robot_log::Estimate& estimate) override { estimates.push_back(estimate); }
  void append(robot_log::Note note) override { notes.push_back(std::move(note)); }
  std::vector<robot_log::Step> steps;
  std::vector<robot_log::Estimate> estimates;
  std::vector<robot_log::Note> notes;
};

/// Delivers what the test puts in, once, and keeps what is published.
struct TestBus {
  template <class Take>
  void receive(const Vec2&, Take take) {
    for (const NeighbourReport& report : std::exchange(arrived, {})) take(report, age);
  }
  void publish(const link::RobotStateMessage& state) { published.push_back(state); }
  std::vector<NeighbourReport> arrived;
  Duration age{};
  std::vector<link::RobotStateMessage> published;
};

/// A robot without a plan at (5, 5) of an empty yard.
class LoneRobot : public ::testing::Test {
 protected:
  LoneRobot() { mission_.robots.count = 2; }

  void tick(Duration lateness = {}) { tick(body_, MissionPhase::kReady, lateness); }
  void tick(Driver& driver, MissionPhase phase, Duration lateness = {}) {
    now_ += kPeriod;
    loop_.step({.now = now_,
                .utc_now = UtcTime(now_.time_since_epoch()),
                .lateness = lateness,
                .period = kPeriod,
                .phase = phase,
                .planner_alive = true},
               {.driver = driver, .rng = rng_, .log = log_, .state_ages = &ages_}, bus_);
  }

  Mission mission_;
  World world_ = *World::make({{0, 0}, {10, 10}}, {});
  SteadyTime now_{std::chrono::seconds(10)};
  RobotLoop loop_{world_, agent_options(mission_, RobotId(0)),
                  agent_identity(mission_, RobotId(0))};
  SimulatedRobot body_{now_, Vec2(5, 5)};
  Rng rng_{1};
  MemoryLog log_;
  Histogram ages_;
  TestBus bus_;
};

/// A body whose position is not known.
struct LostDriver final : Driver {
  Measurement measure(SteadyTime) override {
    Measurement lost;
    lost.is_valid = false;
    return lost;
  }
  void command(SteadyTime, const Vec2&, Duration) override { ++commands; }
  void stop(SteadyTime, StopKind) override { ++stops; }
  int commands = 0;
  int stops = 0;
};

TEST_F(LoneRobot, ObeysAnEmergencyStopWithoutAPosition) {
  LostDriver driver;
  tick(driver, MissionPhase::kRunning);
  EXPECT_EQ(driver.commands, 1);

  tick(driver, MissionPhase::kStopped);

  EXPECT_EQ(driver.stops, 1);
  EXPECT_EQ(loop_.mode(), RobotMode::kStopped);
}

// Otherwise neighbours would take it for a robot that is well somewhere else.
TEST_F(LoneRobot, PublishesItsLastPositionWhileItHasNone) {
  LostDriver driver;
  tick(driver, MissionPhase::kRunning);
  EXPECT_TRUE(bus_.published.empty()) << "it has never had a position";
  tick();
  bus_.published.clear();

  for (int k = 0; k < 5; ++k) tick(driver, MissionPhase::kRunning);

  ASSERT_EQ(bus_.published.size(), 5U);
  EXPECT_EQ(bus_.published[4].x_m, 5.0);
  EXPECT_EQ(bus_.published[4].y_m, 5.0);
  EXPECT_EQ(bus_.published[4].vx_mps, 0.0);
  EXPECT_EQ(loop_.fault(), "the driver has no position; the robot holds");
}

TEST_F(LoneRobot, RecordsEachTickAndItsFirstMode) {
  tick();
  tick();

  ASSERT_EQ(log_.steps.size(), 2U);
  EXPECT_EQ(log_.steps[1].position_m, Vec2(5, 5));
  EXPECT_EQ(log_.steps[1].goal, robot_log::Step::kNoGoal);
  ASSERT_EQ(log_.notes.size(), 1U);
  EXPECT_EQ(log_.notes[0].code, "mode");
  EXPECT_FALSE(loop_.has_updates());
}

TEST_F(LoneRobot, PublishesItsStateWithGrowingNumbers) {
  for (int k = 0; k < 20; ++k) tick();

  ASSERT_GE(bus_.published.size(), 2U);
  EXPECT_EQ(bus_.published[0].sequence_number, 1U);
  EXPECT_EQ(bus_.published[1].sequence_number, 2U);
  EXPECT_EQ(loop_.status().states_sent, bus_.published.size());
}

TEST_F(LoneRobot, CountsTheStatesItUsesOnce) {
  const NeighbourReport report{
      .robot = RobotId(1), .sequence = 1, .as_of = now_, .position_m = {6, 5}};
  bus_.age = kPeriod;
  bus_.arrived = {report, report};  // the second is a duplicate
  tick();

  EXPECT_EQ(loop_.status().states_received, 1U);
  EXPECT_EQ(ages_.count(), 1U);
  EXPECT_EQ(loop_.status().neighbours_heard, 1U);
}

TEST_F(LoneRobot, RecordsItsEstimateOfANeighbour) {
  bus_.arrived = {{.robot = RobotId(1), .sequence = 1, .as_of = now_, .position_m = {6, 5}}};
  for (int k = 0; k < 10; ++k) tick();

  ASSERT_FALSE(log_.estimates.empty());
  EXPECT_EQ(log_.estimates[0].neighbour, RobotId(1));
  EXPECT_EQ(log_.estimates[0].position_m, Vec2(6, 5));
}

TEST_F(LoneRobot, CountsLateTicks) {
  tick(std::chrono::milliseconds(19));
  tick(std::chrono::milliseconds(21));

  EXPECT_EQ(loop_.status().ticks, 2U);
  EXPECT_EQ(loop_.status().late_ticks, 1U);
  EXPECT_EQ(log_.steps[1].lateness_us, 21'000);
}

// As after a stall of 8 s in a tick, and of 0.25 s before one.
TEST_F(LoneRobot, CountsEveryPeriodThatItMissed) {
  tick();
  tick(80 * kPeriod);
  EXPECT_EQ(loop_.status().late_ticks, 80U);
  tick(std::chrono::milliseconds(250));
  EXPECT_EQ(loop_.status().late_ticks, 83U);
  EXPECT_EQ(loop_.status().ticks, 3U);
}

TEST_F(LoneRobot, RecordsWhereItsBodyStoppedWhenTicksFailedToCome) {
  body_.command(now_, {1.0, 0.0}, 2 * kPeriod);
  now_ += 9 * kPeriod;
  tick();

  ASSERT_EQ(log_.steps.size(), 2U);  // the point where it stopped comes first
  EXPECT_NEAR((log_.steps[0].position_m - Vec2(5.2, 5)).norm(), 0.0, 1e-12);
  EXPECT_EQ(log_.steps[1].stamp - log_.steps[0].stamp, 8 * kPeriod);
}

TEST(TickPhase, SpreadsRobotsOverThePeriod) {
  std::vector<int> tenths(10);
  for (std::uint32_t robot = 0; robot < 100; ++robot) {
    ++tenths[static_cast<std::size_t>(10.0 * tick_phase(robot))];
  }
  for (const int robots : tenths) EXPECT_NEAR(robots, 10, 2);
}

TEST(StatusCadence, GivesEachNumberItsTurnOncePerRound) {
  const StatusCadence cadence(10.0, 2.0);
  EXPECT_EQ(cadence.every(), 5U);
  for (std::uint64_t tick = 0; tick < 10; ++tick) {
    for (std::uint64_t number = 0; number < 10; ++number) {
      const bool in_turn = number % 5 == cadence.first_in_turn(tick);
      EXPECT_EQ(cadence.is_due(number, tick), in_turn) << number << " at " << tick;
    }
  }
}

TEST(StatusCadence, ReportsAtEveryTickWhereStatusIsAsFastAsControl) {
  const StatusCadence cadence(10.0, 50.0);
  EXPECT_TRUE(cadence.is_due(3, 4));
}

}  // namespace
}  // namespace swarm::agent
