// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
// What the gate adds to the checks of single messages: order, future, ownership, counting.
#include "swarm_link/gate/gate.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "swarm_link/to_message.hpp"

namespace swarm::link {
namespace {

constexpr UtcTime kNow{std::chrono::seconds(1'700'000'000)};
constexpr Duration kRefuse = std::chrono::seconds(10);
constexpr Duration kTakeover = std::chrono::milliseconds(700);
constexpr auto kHuge = std::numeric_limits<std::uint64_t>::max();

std::int64_t ns(UtcTime t) { return t.time_since_epoch().count(); }
std::uint64_t id(UtcTime t) { return static_cast<std::uint64_t>(ns(t)); }
UtcTime s_later(int s) { return kNow + std::chrono::seconds(s); }

WireLimits limits() {
  return {.robots = 100,
          .bounds_m = {.min_m = {0.0, 0.0}, .max_m = {50.0, 40.0}},
          .clock_skew_warn = std::chrono::milliseconds(250),
          .clock_skew_refuse = kRefuse,
          .planner_takeover = kTakeover,
          .status_takeover = std::chrono::seconds(10)};
}

/// One leg from (10, 10) to (20, 10).
PlanMessage plan(std::uint64_t epoch, std::uint32_t version) {
  return {.version = version,
          .epoch = epoch,
          .nodes = {{10, 10, 1.0, 0.0, 1.0, 0.0, 1.0}, {20, 10, 1.0, 0.0, 1.0, 5.0, 1.0}},
          .legs = {{0, 1, 1.0}}};
}
HeartbeatMessage heartbeat(std::uint64_t epoch, std::uint64_t number) {
  return {.epoch = epoch, .sequence_number = number, .stamp_utc_ns = ns(kNow)};
}
SceneMessage scene(std::uint64_t version) {
  SceneMessage message = to_message(first_scene(2));
  message.version = version;
  return message;
}
CommandMessage command(CommandKind kind, std::uint64_t command_id) {
  return {.kind = kind, .command_id = command_id, .stamp_utc_ns = ns(kNow)};
}
RobotStateMessage state(std::uint32_t robot, UtcTime stamp) {
  return {.robot_id = robot, .sequence_number = 1, .stamp_utc_ns = ns(stamp), .x_m = 5, .y_m = 5};
}

struct GateTest : testing::Test {
  /// Whether the gate refused exactly one message since the last call, for this reason.
  testing::AssertionResult counted(RefusalReason reason) {
    RefusalCounters expected = before;
    expected.count(reason);
    before = sut.refused();
    if (before == expected) return testing::AssertionSuccess();
    return testing::AssertionFailure() << to_string(reason) << " is not what was counted";
  }

  Gate sut{{.limits = limits()}};
  RefusalCounters before;
};

TEST_F(GateTest, LetsPlansThroughInTheOrderOfEpochAndVersion) {
  const std::uint64_t epoch = id(s_later(-100));
  EXPECT_TRUE(sut.plan(plan(epoch, 1), kNow));
  EXPECT_TRUE(sut.plan(plan(epoch, 4), kNow));
  EXPECT_FALSE(sut.plan(plan(epoch, 4), kNow));
  EXPECT_TRUE(counted(RefusalReason::kDuplicate));
  EXPECT_FALSE(sut.plan(plan(epoch, 3), kNow));
  EXPECT_TRUE(counted(RefusalReason::kStale));
}

TEST_F(GateTest, FollowsAnotherPlannerOnlyAfterSilence) {
  const std::uint64_t first = id(s_later(-100)), second = id(s_later(-50));
  EXPECT_TRUE(sut.plan(plan(first, 7), kNow));
  EXPECT_TRUE(sut.heartbeat(heartbeat(first, 500), kNow));

  EXPECT_FALSE(sut.plan(plan(second, 1), kNow + kTakeover));
  EXPECT_TRUE(counted(RefusalReason::kStale));
  EXPECT_FALSE(sut.heartbeat(heartbeat(second, 1), kNow + kTakeover));
  EXPECT_TRUE(counted(RefusalReason::kStale));
  EXPECT_EQ(sut.foreign_heartbeats(), 1U);
  EXPECT_EQ(sut.planner_epoch(), first);

  const UtcTime later = kNow + kTakeover + std::chrono::nanoseconds(1);
  EXPECT_TRUE(sut.heartbeat(heartbeat(second, 2), later));
  EXPECT_EQ(sut.planner_epoch(), second);
  EXPECT_TRUE(sut.plan(plan(second, 1), later));
  EXPECT_FALSE(sut.plan(plan(first, 8), later));
  EXPECT_TRUE(counted(RefusalReason::kStale));
  EXPECT_FALSE(sut.heartbeat(heartbeat(first, 501), later));
  EXPECT_TRUE(counted(RefusalReason::kStale));
}

// A planner with a later epoch that was followed by mistake is left when it is silent.
TEST_F(GateTest, ComesBackToAnOlderPlanner) {
  const std::uint64_t real = id(s_later(-100)), foreign = id(kNow);
  EXPECT_TRUE(sut.heartbeat(heartbeat(foreign, 1), kNow));
  EXPECT_FALSE(sut.heartbeat(heartbeat(real, 300), kNow));
  EXPECT_TRUE(sut.heartbeat(heartbeat(real, 301), kNow + 2 * kTakeover));
  EXPECT_TRUE(sut.plan(plan(real, 4), kNow + 2 * kTakeover));
}

TEST_F(GateTest, OfARecordingFollowsTheNewestPlannerAtOnce) {
  Gate recorded{{.limits = limits(), .stamps = Stamps::kRecorded}};
  const std::uint64_t first = id(s_later(-100)), second = id(s_later(-50));
  EXPECT_TRUE(recorded.plan(plan(first, 7), kNow));
  EXPECT_TRUE(recorded.heartbeat(heartbeat(first, 500), kNow));
  EXPECT_FALSE(recorded.heartbeat(heartbeat(first, 499), kNow + 2 * kTakeover));
  EXPECT_TRUE(recorded.plan(plan(second, 1), kNow));
  EXPECT_TRUE(recorded.heartbeat(heartbeat(second, 1), kNow));
  EXPECT_FALSE(recorded.plan(plan(first, 8), kNow));
  EXPECT_FALSE(recorded.heartbeat(heartbeat(first, 501), kNow + 2 * kTakeover));
}

// A plan shows a planner's epoch; only heartbeats show that it is alive.
TEST_F(GateTest, FollowsTheHeartbeatsOfAnyPlannerAfterAPlanAlone) {
  EXPECT_TRUE(sut.plan(plan(id(kNow), 1), kNow));
  EXPECT_TRUE(sut.heartbeat(heartbeat(id(s_later(-100)), 300), kNow));
  EXPECT_EQ(sut.planner_epoch(), id(s_later(-100)));
}

// An invented number may be as high as the epoch allows: it holds for the takeover time only.
TEST_F(GateTest, ForgetsTheNumberOfAHeartbeatAfterSilence) {
  const std::uint64_t epoch = id(s_later(-100));
  EXPECT_TRUE(sut.heartbeat(heartbeat(epoch, 90'000), kNow));
  EXPECT_FALSE(sut.heartbeat(heartbeat(epoch, 500), kNow + kTakeover));
  EXPECT_TRUE(sut.heartbeat(heartbeat(epoch, 501), kNow + 2 * kTakeover));
  EXPECT_TRUE(sut.heartbeat(heartbeat(epoch, 502), kNow + 2 * kTakeover));
}

TEST_F(GateTest, RefusesAHeartbeatWithoutNumberWithoutForgettingThePlan) {
  const std::uint64_t epoch = id(s_later(-100));
  EXPECT_TRUE(sut.plan(plan(epoch, 3), kNow));
  EXPECT_FALSE(sut.heartbeat(heartbeat(id(s_later(-50)), 0), kNow));
  EXPECT_FALSE(sut.plan(plan(epoch, 3), kNow));
}

TEST_F(GateTest, RefusesEpochsOfTheFuture) {
  EXPECT_FALSE(sut.plan(plan(kHuge, 1), kNow));
  EXPECT_TRUE(counted(RefusalReason::kForged));
  EXPECT_FALSE(sut.plan(plan(id(kNow + kRefuse) + 1, 1), kNow));
  EXPECT_TRUE(counted(RefusalReason::kForged));
  EXPECT_FALSE(sut.heartbeat(heartbeat(kHuge, 1), kNow));
  EXPECT_TRUE(counted(RefusalReason::kForged));
  EXPECT_TRUE(sut.plan(plan(id(kNow + kRefuse), 1), kNow));
  EXPECT_TRUE(sut.heartbeat(heartbeat(id(kNow + kRefuse), 1), kNow));
}

TEST_F(GateTest, RefusesPlansForScenesOfTheFuture) {
  PlanMessage ahead = plan(id(kNow), 1);
  ahead.scene_version = id(kNow + kRefuse) + 1;
  EXPECT_FALSE(sut.plan(ahead, kNow));
  EXPECT_TRUE(counted(RefusalReason::kForged));
}

// One message with the largest number of a planner's epoch would outrank all that it sends later.
TEST_F(GateTest, RefusesNumbersThatAnEpochCannotHaveReached) {
  const std::uint64_t epoch = id(s_later(-100));
  EXPECT_FALSE(sut.plan(plan(epoch, 0xFFFF'FFFF), kNow));
  EXPECT_TRUE(counted(RefusalReason::kForged));
  EXPECT_FALSE(sut.heartbeat(heartbeat(epoch, kHuge), kNow));
  EXPECT_TRUE(counted(RefusalReason::kForged));
  EXPECT_TRUE(sut.plan(plan(epoch, 100'000), kNow));
  EXPECT_TRUE(sut.heartbeat(heartbeat(epoch, 100'000), kNow));
  EXPECT_TRUE(sut.heartbeat(heartbeat(id(s_later(9)), 900), kNow + 2 * kTakeover))
      << "of a planner just begun";
}

TEST_F(GateTest, RefusesHeartbeatsStampedInTheFuture) {
  HeartbeatMessage beat = heartbeat(id(kNow), 1);
  beat.stamp_utc_ns = ns(kNow + kRefuse) + 1;
  EXPECT_FALSE(sut.heartbeat(beat, kNow));
  EXPECT_TRUE(counted(RefusalReason::kForged));
  beat.stamp_utc_ns = ns(s_later(-3600));  // our clock is wrong, not the planner's
  EXPECT_TRUE(sut.heartbeat(beat, kNow));
}

TEST_F(GateTest, LetsTheFirstSceneThroughAndThenNewerOnes) {
  EXPECT_TRUE(sut.scene(scene(0), kNow));
  EXPECT_FALSE(sut.scene(scene(0), kNow));
  EXPECT_TRUE(counted(RefusalReason::kDuplicate));
  EXPECT_TRUE(sut.scene(scene(id(kNow)), kNow));
  EXPECT_FALSE(sut.scene(scene(id(s_later(-1))), kNow));
  EXPECT_TRUE(counted(RefusalReason::kStale));
  EXPECT_FALSE(sut.scene(scene(kHuge), kNow));
  EXPECT_TRUE(counted(RefusalReason::kForged));
  EXPECT_TRUE(sut.scene(scene(id(s_later(1))), kNow));
}

TEST_F(GateTest, LetsCommandsThroughInTheOrderOfTheirIds) {
  EXPECT_TRUE(sut.command(command(CommandKind::kStart, 10), kNow));
  EXPECT_FALSE(sut.command(command(CommandKind::kPause, 10), kNow));
  EXPECT_TRUE(counted(RefusalReason::kDuplicate));
  EXPECT_FALSE(sut.command(command(CommandKind::kPause, 9), kNow));
  EXPECT_TRUE(counted(RefusalReason::kStale));
  EXPECT_TRUE(sut.command(command(CommandKind::kPause, 11), kNow));
}

TEST_F(GateTest, LetsEveryStopThroughWhateverItsIdIs) {
  EXPECT_TRUE(sut.command(command(CommandKind::kStart, 10), kNow));
  EXPECT_TRUE(sut.command(command(CommandKind::kStop, 1), kNow));
  EXPECT_TRUE(sut.command(command(CommandKind::kStop, 1), kNow));
  EXPECT_TRUE(sut.command(command(CommandKind::kStop, kHuge), kNow));
  EXPECT_TRUE(sut.command(command(CommandKind::kPause, 11), kNow)) << "a stop is no newest command";
}

TEST_F(GateTest, IsNotLockedByACommandWithAHugeId) {
  for (const std::uint64_t huge : {kHuge, kHuge - 1, std::uint64_t{1} << 63}) {
    EXPECT_FALSE(sut.command(command(CommandKind::kPause, huge), kNow));
    EXPECT_TRUE(counted(RefusalReason::kForged));
  }
  EXPECT_TRUE(sut.command(command(CommandKind::kPause, id(kNow)), kNow));
  EXPECT_TRUE(sut.command(command(CommandKind::kResume, id(kNow) + 1), kNow));
}

TEST_F(GateTest, RefusesCommandsStampedInTheFuture) {
  CommandMessage start = command(CommandKind::kStart, 10);
  start.stamp_utc_ns = std::numeric_limits<std::int64_t>::max();  // would be the mission's t0
  EXPECT_FALSE(sut.command(start, kNow));
  EXPECT_TRUE(counted(RefusalReason::kForged));
}

// Their difference to the clock would not fit in 64 bits.
TEST_F(GateTest, RefusesStampsFromBeforeTheRangeOfClocks) {
  constexpr std::int64_t kFirst = std::numeric_limits<std::int64_t>::min();
  CommandMessage start = command(CommandKind::kStart, 10);
  start.stamp_utc_ns = kFirst;
  EXPECT_FALSE(sut.command(start, kNow));
  EXPECT_TRUE(counted(RefusalReason::kOutOfRange));
  CommandMessage stop = command(CommandKind::kStop, 10);
  stop.stamp_utc_ns = kFirst;
  EXPECT_TRUE(sut.command(stop, kNow)) << "a stop passes with any stamp";
  EXPECT_FALSE(sut.status({.stamp_utc_ns = kFirst, .robots = {{.robot_id = 1}}}, kNow));
  EXPECT_TRUE(counted(RefusalReason::kOutOfRange));
  EXPECT_FALSE(sut.heartbeat({.epoch = 1, .sequence_number = 1, .stamp_utc_ns = kFirst}, kNow));
  EXPECT_TRUE(counted(RefusalReason::kOutOfRange));
  EXPECT_FALSE(sut.event({.source = 0, .stamp_utc_ns = kFirst, .code = "note"}));
  EXPECT_TRUE(counted(RefusalReason::kOutOfRange));
}

TEST_F(GateTest, RefusesStatusesOfTheFuture) {
  StatusMessage status{.stamp_utc_ns = ns(kNow), .robots = {{.robot_id = 1}}};
  EXPECT_TRUE(sut.status(status, kNow));
  EXPECT_TRUE(sut.status(status, kNow)) << "statuses have no order";
  StatusMessage ahead = status;
  ahead.stamp_utc_ns = ns(kNow + kRefuse) + 1;
  EXPECT_FALSE(sut.status(ahead, kNow));
  EXPECT_TRUE(counted(RefusalReason::kClockSkew));
  ahead = status;
  ahead.plan_epoch = kHuge;
  EXPECT_FALSE(sut.status(ahead, kNow));
  EXPECT_TRUE(counted(RefusalReason::kForged));
  ahead = status;
  ahead.plan_scene_version = kHuge;  // would have arrived at every goal to come
  EXPECT_FALSE(sut.status(ahead, kNow));
  EXPECT_TRUE(counted(RefusalReason::kForged));
}

// A host that was suspended goes on with the clock of before: its states are refused, too.
TEST_F(GateTest, RefusesStatusesThatAreTooOldUnlessTheyAreRecorded) {
  StatusMessage status{.stamp_utc_ns = ns(kNow - kRefuse), .robots = {{.robot_id = 1}}};
  EXPECT_TRUE(sut.status(status, kNow));
  --status.stamp_utc_ns;
  EXPECT_FALSE(sut.status(status, kNow));
  EXPECT_TRUE(counted(RefusalReason::kClockSkew));

  Gate recorded{{.limits = limits(), .stamps = Stamps::kRecorded}};
  EXPECT_TRUE(recorded.status(status, kNow));
}

constexpr std::uint64_t kRobots = 11, kPlanner = 12, kForger = 13;

TEST_F(GateTest, TakesStatusesOfARobotFromItsOwnSender) {
  const StatusMessage status{.stamp_utc_ns = ns(kNow), .robots = {{.robot_id = 1}}};
  EXPECT_TRUE(sut.status_of(status, {kRobots, kNow}));
  EXPECT_FALSE(sut.status_of(status, {kForger, kNow}));
  EXPECT_TRUE(counted(RefusalReason::kForged));
  sut.release_status(RobotId(1), s_later(1));
  EXPECT_FALSE(sut.status_of(status, {kRobots, s_later(1)})) << "sent before the process ended";
  EXPECT_TRUE(counted(RefusalReason::kStale));
  StatusMessage bad = status;
  bad.robots[0].robot_id = 100;
  EXPECT_FALSE(sut.status_of(bad, {kRobots, kNow}));
  EXPECT_TRUE(counted(RefusalReason::kOutOfRange));
}

// Others report events in a robot's or the planner's name only before that is received.
TEST_F(GateTest, TakesEventsThatTheirSourceMayHaveSent) {
  const EventMessage of_robot{.source = 1, .stamp_utc_ns = ns(kNow), .code = "note"};
  const EventMessage of_planner{.source = kPlannerSource, .stamp_utc_ns = ns(kNow), .code = "note"};
  EXPECT_TRUE(sut.event_of(of_robot, {kRobots, kNow}, false)) << "before its first status";
  EXPECT_TRUE(sut.event_of(of_planner, {kForger, kNow}, false)) << "a planner that stands by";
  EXPECT_FALSE(sut.event_of(of_robot, {kRobots, kNow}, true));
  EXPECT_TRUE(counted(RefusalReason::kForged));
  EXPECT_FALSE(sut.event_of(of_planner, {kPlanner, kNow}, true));
  EXPECT_TRUE(counted(RefusalReason::kForged));

  EXPECT_TRUE(
      sut.status_of({.stamp_utc_ns = ns(kNow), .robots = {{.robot_id = 1}}}, {kRobots, kNow}));
  EXPECT_TRUE(sut.heartbeat_of(heartbeat(id(kNow), 1), {kPlanner, kNow}));
  for (const bool is_evidence : {false, true}) {
    EXPECT_TRUE(sut.event_of(of_robot, {kRobots, kNow}, is_evidence));
    EXPECT_TRUE(sut.event_of(of_planner, {kPlanner, kNow}, is_evidence));
    EXPECT_FALSE(sut.event_of(of_robot, {kForger, kNow}, is_evidence));
    EXPECT_TRUE(counted(RefusalReason::kForged));
  }
  EXPECT_FALSE(sut.event_of(of_planner, {kForger, kNow}, true));
  EXPECT_TRUE(counted(RefusalReason::kForged));

  sut.release_status(RobotId(1), kNow);
  EXPECT_TRUE(sut.event_of(of_robot, {kRobots, kNow}, true))
      << "the last events of a process that has ended";
  EXPECT_FALSE(sut.event_of(of_robot, {kForger, kNow}, true));
  EXPECT_TRUE(counted(RefusalReason::kForged));
}

TEST_F(GateTest, KnowsTheEchoesOfItsOwnRobots) {
  EchoGuard own;
  own.record_sent(state(3, kNow));
  EXPECT_TRUE(sut.state(state(3, kNow), kNow, &own));
  EXPECT_FALSE(sut.state(state(3, s_later(1)), kNow, &own));
  EXPECT_TRUE(counted(RefusalReason::kForged));
  EXPECT_TRUE(sut.state(state(4, s_later(1)), kNow));
}

TEST_F(GateTest, RefusesOldStatesOnlyWhereStampsAreLive) {
  Gate replay{{.limits = limits(), .stamps = Stamps::kRecorded}};
  EXPECT_FALSE(sut.state(state(3, s_later(-11)), kNow));
  EXPECT_TRUE(counted(RefusalReason::kClockSkew));
  EXPECT_TRUE(replay.state(state(3, s_later(-11)), kNow));
  EXPECT_FALSE(replay.state(state(3, s_later(11)), kNow));
  EXPECT_EQ(replay.refused()[RefusalReason::kClockSkew], 1U);
}

// An invented stamp keeps the robot's own states out for a second, not for ten.
TEST_F(GateTest, LetsNoStateThroughThatIsFarAhead) {
  EXPECT_FALSE(sut.newer_state(state(3, s_later(2)), kNow));
  EXPECT_TRUE(counted(RefusalReason::kClockSkew));
  EXPECT_TRUE(sut.newer_state(state(3, kNow), kNow));
}

TEST_F(GateTest, LetsEachNewerStateThroughOnce) {
  EXPECT_TRUE(sut.newer_state(state(3, kNow), kNow));
  EXPECT_FALSE(sut.newer_state(state(3, kNow), kNow));
  EXPECT_TRUE(counted(RefusalReason::kDuplicate));
  EXPECT_FALSE(sut.newer_state(state(3, s_later(-1)), kNow));
  EXPECT_TRUE(counted(RefusalReason::kStale));
  EXPECT_TRUE(sut.newer_state(state(99, s_later(-1)), kNow)) << "of another robot";
  EXPECT_FALSE(sut.newer_state(state(100, kNow), kNow));
  EXPECT_TRUE(counted(RefusalReason::kOutOfRange));
}

TEST_F(GateTest, RefusesEventsUnderItsOwnName) {
  Gate launcher{{.limits = limits(), .own_source = kLauncherSource}};
  const EventMessage event{.source = kLauncherSource, .code = "exit"};
  EXPECT_TRUE(sut.event(event));
  EXPECT_FALSE(launcher.event(event));
  EXPECT_EQ(launcher.refused()[RefusalReason::kForged], 1U);
}

TEST_F(GateTest, ChangesNothingForARefusedMessage) {
  PlanMessage spoiled = plan(id(kNow), 9);
  spoiled.legs[0].mass = 7;
  EXPECT_FALSE(sut.plan(spoiled, kNow));
  EXPECT_TRUE(counted(RefusalReason::kBadMass));
  EXPECT_TRUE(sut.plan(plan(id(kNow), 1), kNow)) << "version 9 was not accepted";
}

TEST_F(GateTest, CountsSamplesThatDoNotDecode) {
  sut.set_undecodable(0);
  sut.set_undecodable(2);
  sut.set_undecodable(2);
  EXPECT_EQ(sut.refused()[RefusalReason::kUndecodable], 2U);
}

}  // namespace
}  // namespace swarm::link
