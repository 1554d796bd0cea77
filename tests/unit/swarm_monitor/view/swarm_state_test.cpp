// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/swarm_state.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/swarm_monitor/bus_samples.hpp"

namespace swarm::monitor {
namespace {

class SwarmStateTest : public testing::Test {
 protected:
  void receive_state(std::uint32_t robot, double at_s, const Vec2& at_m,
                     const Vec2& velocity_mps = Vec2::Zero(), RobotMode mode = RobotMode::kMoving) {
    deliver(state_, "swarm/cell", second(at_s),
            batch_of({{.robot_id = robot,
                       .sequence_number = ++number_,
                       .stamp_utc_ns = utc_ns(second(at_s)),
                       .x_m = at_m.x(),
                       .y_m = at_m.y(),
                       .vx_mps = velocity_mps.x(),
                       .vy_mps = velocity_mps.y(),
                       .mode = mode}}));
  }
  void receive_status(double at_s, link::RobotStatusMessage robot) {
    link::StatusMessage message;
    message.robots = {robot};
    deliver(state_, "swarm/status", second(at_s), message);
  }
  void receive_beat(double at_s, MissionPhase phase, double mission_time_s, double plan_time_s,
                    double rate) {
    deliver(state_, "swarm/heartbeat", second(at_s),
            link::HeartbeatMessage{.phase = phase,
                                   .version = 1,
                                   .epoch = 1,
                                   .sequence_number = ++number_,
                                   .stamp_utc_ns = utc_ns(second(at_s)),
                                   .mission_time_s = mission_time_s,
                                   .plan_time_s = plan_time_s,
                                   .plan_rate = rate});
  }
  const SwarmState::Robot& robot(std::size_t i) const { return state_.robots()[i]; }

  std::uint32_t number_ = 0;
  SwarmState state_{four_robots(), link::Stamps::kRecorded};
};

TEST_F(SwarmStateTest, BeginsEmpty) {
  ASSERT_EQ(state_.robots().size(), 4U);
  EXPECT_FALSE(state_.begin() || state_.plan());
  const auto counts = state_.counts(second(0));
  EXPECT_EQ(counts.received + counts.moving + counts.arrived + counts.lost, 0U);
  EXPECT_TRUE(std::isinf(counts.nearest_gap_m));
  EXPECT_EQ(state_.phase(), MissionPhase::kReady);
  EXPECT_FALSE(state_.is_lost(robot(0), second(1e6))) << "never received is not lost";
}

TEST_F(SwarmStateTest, ExtrapolatesForEightTenthsOfASecond) {
  receive_state(1, 10.0, {5, 6}, {1.0, -0.5});

  for (const auto& [age_s, moved_s] :
       {std::pair{-0.5, 0.0}, {0.0, 0.0}, {0.4, 0.4}, {0.8, 0.8}, {0.9, 0.8}, {60.0, 0.8}}) {
    const Vec2 expected = Vec2(5, 6) + moved_s * Vec2(1.0, -0.5);
    EXPECT_NEAR((state_.position_of(robot(1), second(10.0 + age_s)) - expected).norm(), 0.0, 1e-9)
        << age_s;
  }
}

TEST_F(SwarmStateTest, LosesARobotThatIsSilentForThreeSeconds) {
  receive_state(1, 10.0, {5, 6});
  EXPECT_FALSE(state_.is_lost(robot(1), second(13.0)));
  EXPECT_TRUE(state_.is_lost(robot(1), second(13.001)));

  // A status alone keeps it, although its position is not that of the status.
  receive_status(12.5, {.robot_id = 1, .x_m = 30, .y_m = 15});

  EXPECT_FALSE(state_.is_lost(robot(1), second(15.0)));
  EXPECT_EQ(robot(1).position_m, Vec2(5, 6));
  EXPECT_TRUE(state_.is_lost(robot(1), second(15.6)));
}

TEST_F(SwarmStateTest, TakesAPositionOfAStatusUntilThereIsAState) {
  receive_status(1.0, {.robot_id = 2, .x_m = 3, .y_m = 4});
  EXPECT_EQ(robot(2).position_m, Vec2(3, 4));

  receive_state(2, 1.5, {7, 8});

  EXPECT_EQ(robot(2).position_m, Vec2(7, 8));
}

TEST_F(SwarmStateTest, CountsRobotsByWhatTheyDo) {
  receive_state(0, 1.0, {1, 1}, {0, 0}, RobotMode::kMoving);
  receive_state(1, 1.0, {2, 1}, {0, 0}, RobotMode::kArrived);
  receive_state(2, 8.0, {3, 1}, {0, 0}, RobotMode::kHolding);
  receive_status(
      8.0, {.robot_id = 2, .mode = RobotMode::kMoving, .x_m = 3, .y_m = 1, .nearest_gap_m = 0.5});
  receive_status(
      8.0, {.robot_id = 0, .mode = RobotMode::kMoving, .x_m = 1, .y_m = 1, .nearest_gap_m = 0.75});

  const auto counts = state_.counts(second(8.0));

  EXPECT_EQ(counts.received, 3U);
  EXPECT_EQ(counts.moving, 2U);
  EXPECT_EQ(counts.arrived, 1U);
  EXPECT_EQ(counts.lost, 1U) << "robot 1, silent for 7 s";
  EXPECT_EQ(counts.nearest_gap_m, 0.5);
}

TEST_F(SwarmStateTest, ContinuesTheClocksForAtMostASecond) {
  receive_beat(10.0, MissionPhase::kRunning, 7.0, 5.0, 0.5);

  for (const auto& [age_s, passed_s] : {std::pair{-1.0, 0.0}, {0.4, 0.4}, {1.0, 1.0}, {9.0, 1.0}}) {
    EXPECT_NEAR(state_.mission_time_s(second(10.0 + age_s)), 7.0 + passed_s, 1e-9) << age_s;
    EXPECT_NEAR(state_.plan_time_s(second(10.0 + age_s)), 5.0 + 0.5 * passed_s, 1e-9) << age_s;
  }
  EXPECT_EQ(state_.plan_rate(), 0.5);
}

TEST_F(SwarmStateTest, StopsTheClocksInAPause) {
  receive_beat(10.0, MissionPhase::kPaused, 7.0, 5.0, 0.0);

  EXPECT_EQ(state_.phase(), MissionPhase::kPaused);
  EXPECT_EQ(state_.mission_time_s(second(10.9)), 7.0);
  EXPECT_EQ(state_.plan_time_s(second(10.9)), 5.0);
}

TEST_F(SwarmStateTest, ChangesItsVersionWithPlanAndSceneAlone) {
  receive_state(0, 1.0, {1, 1});
  receive_beat(1.0, MissionPhase::kRunning, 1.0, 1.0, 1.0);
  EXPECT_EQ(state_.version(), 0U);

  link::PlanMessage plan =
      link::to_message(straight_plan(), PlannerEpoch(1), PlanVersion(1), second(1));
  plan.excess_m = 0.5;
  deliver(state_, "swarm/plan", second(1.0), plan);
  EXPECT_EQ(state_.version(), 1U);
  plan.version = 2;
  plan.excess_m = 0.25;
  deliver(state_, "swarm/plan", second(2.0), plan);
  EXPECT_EQ(state_.version(), 2U);
  EXPECT_EQ(state_.plan_version(), 2U);
  EXPECT_EQ(state_.plan_excess_m(), 0.5) << "the largest so far";

  const auto scene = after(state_.scene(), RemoveObstacle{0}, four_robots().world, second(2));
  deliver(state_, "swarm/scene", second(2.0), link::to_message(scene.value()));
  EXPECT_EQ(state_.version(), 3U);
  EXPECT_EQ(state_.scene().removed, std::vector<std::uint32_t>{0});
}

TEST_F(SwarmStateTest, ChangesNothingByAMessageThatIsRefused) {
  receive_state(0, 1.0, {1, 1});

  receive_state(0, 1.5, {1e9, 1});
  receive_state(7, 1.5, {1, 1});

  EXPECT_EQ(robot(0).position_m, Vec2(1, 1));
  EXPECT_EQ(robot(0).received, second(1.0));
  EXPECT_EQ(state_.meter().counts().received, 1U);
  EXPECT_EQ(state_.refused().total(), 2U);
}

TEST_F(SwarmStateTest, TimesEventsFromTheFirstState) {
  const link::EventMessage event{.source = 1, .code = "a", .text = "b"};
  deliver(state_, "swarm/event", second(1.0), event);
  receive_state(0, 4.0, {1, 1});
  deliver(state_, "swarm/event", second(6.5), event);

  ASSERT_EQ(state_.events().size(), 2U);
  EXPECT_EQ(state_.events()[0].time_s, 0.0) << "before there is a begin";
  EXPECT_NEAR(state_.events()[1].time_s, 2.5, 1e-9);
  EXPECT_EQ(*state_.begin(), second(4.0));
}

}  // namespace
}  // namespace swarm::monitor
