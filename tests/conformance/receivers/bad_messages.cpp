// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/conformance/receivers/bad_messages.hpp"

#include <utility>

#include "swarm_link/to_message.hpp"
#include "swarm_link/wire_bounds.hpp"

namespace swarm::link::conformance {

namespace {

Basis basis;

}  // namespace

std::int64_t ns_after(int seconds) {
  return (basis.now + std::chrono::seconds(seconds)).time_since_epoch().count();
}
std::uint64_t id_after(int seconds) { return static_cast<std::uint64_t>(ns_after(seconds)); }

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

PlanMessage plan(int n) {
  return {.version = static_cast<std::uint32_t>(n) + 4,
          .epoch = basis.epoch,
          .scene_version = id_after(-60),
          .nodes = {{10, 10, 1.0, 0.0, 1.0, 0.0, 1.0}, {20, 10.0 + n, 1.0, 0.0, 1.0, 5.0, 1.0}},
          .legs = {{0, 1, 1.0}}};
}
SceneMessage scene(int n) {
  SceneMessage message = to_message(first_scene(2));
  message.version = id_after(-60 + n);
  message.next_id = 3;
  message.obstacles = {{.obstacle_id = 2, .center = {5, 5}, .radius_m = 1}};
  return message;
}
HeartbeatMessage heartbeat(int n) {
  return {.phase = n == 1 ? MissionPhase::kReady : MissionPhase::kRunning,
          .version = 5,
          .epoch = basis.epoch,
          .sequence_number = static_cast<std::uint64_t>(n) + 200,
          .stamp_utc_ns = ns_after(-2 + n),
          .mission_time_s = 40.0 + n,
          .plan_time_s = 30.0 + n,
          .plan_rate = 1.0};
}
CommandMessage command(int n) {
  return {.kind = n == 1 ? CommandKind::kStart : CommandKind::kPause,
          .command_id = id_after(-50 + n),
          .stamp_utc_ns = ns_after(-50 + n)};
}
StatusMessage status(int n) {
  const auto ticks = static_cast<std::uint32_t>(n);
  return {.first_robot_id = 2,
          .plan_version = 5,
          .plan_epoch = basis.epoch,
          .plan_scene_version = id_after(-60),
          .stamp_utc_ns = ns_after(-2 + n),
          .robots = {{.robot_id = 2, .x_m = 4, .y_m = 4, .ticks = ticks}}};
}
EventMessage event(int n) {
  return {.source = 3, .stamp_utc_ns = ns_after(n), .code = "exit", .text = "graceful end"};
}
CellStatesMessage batch(int n) {
  return {.states = {{.robot_id = 7,
                      .sequence_number = static_cast<std::uint32_t>(n) + 40,
                      .stamp_utc_ns = ns_after(-2 + n),
                      .x_m = 10,
                      .y_m = 10.0 + n,
                      .mode = RobotMode::kMoving}}};
}

/// Message 2 of a topic, spoiled in one way.
template <class M, class Spoil>
Case spoiled(const std::string& name, M message, RefusalReason reason, Spoil spoil) {
  spoil(message);
  return {.name = name, .bad = std::move(message), .reason = reason};
}

std::vector<Case> plan_cases() {
  using R = RefusalReason;
  using P = PlanMessage;
  return {
      spoiled("PlanOfAnotherSchema", plan(2), R::kSchema, [](P& p) { p.schema_version = 99; }),
      spoiled("PlanTooLong", plan(2), R::kOversized, [](P& p) { p.nodes.resize(4097); }),
      spoiled("PlanNotFinite", plan(2), R::kNotFinite, [](P& p) { p.nodes[1].mean_x_m = kNaN; }),
      spoiled("PlanOutsideTheMap", plan(2), R::kOutOfRange,
              [](P& p) { p.nodes[1].mean_x_m = 1e6; }),
      spoiled("PlanLegToNowhere", plan(2), R::kOutOfRange, [](P& p) { p.legs[0].to_node = 4000; }),
      spoiled("PlanForStrangers", plan(2), R::kOutOfRange, [](P& p) { p.entries.resize(13); }),
      spoiled("PlanNotPositiveDefinite", plan(2), R::kBadGaussian,
              [](P& p) { p.nodes[0].covariance_xy_m2 = 100; }),
      spoiled("PlanNotAFlow", plan(2), R::kBadMass, [](P& p) { p.legs[0].mass = 0.5; }),
      spoiled("PlanOlder", plan(2), R::kStale, [](P& p) { p.version = 1; }),
      spoiled("PlanOfAForeignEpoch", plan(2), R::kStale, [](P& p) { p.epoch = id_after(-9999); }),
      spoiled("PlanOfALaterEpoch", plan(2), R::kStale,
              [](P& p) {
                p.epoch = id_after(0);
                p.version = 1;
              }),
      spoiled("PlanAgain", plan(2), R::kDuplicate, [](P& p) { p = plan(1); }),
      spoiled("PlanOfTheFuture", plan(2), R::kForged, [](P& p) { p.epoch = kHuge; }),
      spoiled("PlanHugeVersion", plan(2), R::kForged, [](P& p) { p.version = 0xFFFF'FFFF; }),
      spoiled("PlanForASceneOfTheFuture", plan(2), R::kForged,
              [](P& p) { p.scene_version = kHuge; }),
  };
}

std::vector<Case> scene_cases() {
  using R = RefusalReason;
  using S = SceneMessage;
  return {
      spoiled("SceneOfAnotherSchema", scene(2), R::kSchema, [](S& s) { s.schema_version = 99; }),
      spoiled("SceneTooLong", scene(2), R::kOversized, [](S& s) { s.vertices.resize(4097); }),
      spoiled("SceneNotFinite", scene(2), R::kOutOfRange,
              [](S& s) { s.obstacles[0].center.x_m = kNaN; }),
      spoiled("SceneBodyOfAStranger", scene(2), R::kOutOfRange,
              [](S& s) {
                s.obstacles[0].owner_robot_id = 99;
                s.obstacles[0].obstacle_id = 0x8000'0000 + 99;
              }),
      spoiled("SceneOlder", scene(2), R::kStale, [](S& s) { s.version = id_after(-70); }),
      spoiled("SceneAgain", scene(2), R::kDuplicate, [](S& s) { s = scene(1); }),
      spoiled("SceneOfTheFuture", scene(2), R::kForged, [](S& s) { s.version = kHuge; }),
  };
}

std::vector<Case> heartbeat_cases() {
  using R = RefusalReason;
  using H = HeartbeatMessage;
  return {
      spoiled("HeartbeatOfAnotherSchema", heartbeat(2), R::kSchema,
              [](H& h) { h.schema_version = 99; }),
      spoiled("HeartbeatNotFinite", heartbeat(2), R::kNotFinite,
              [](H& h) { h.plan_time_s = kNaN; }),
      spoiled("HeartbeatTooFast", heartbeat(2), R::kOutOfRange, [](H& h) { h.plan_rate = 2.0; }),
      spoiled("HeartbeatNoPhase", heartbeat(2), R::kOutOfRange,
              [](H& h) { h.phase = static_cast<MissionPhase>(9); }),
      spoiled("HeartbeatOlder", heartbeat(2), R::kStale, [](H& h) { h.sequence_number = 1; }),
      spoiled("HeartbeatOfAForeignEpoch", heartbeat(2), R::kStale,
              [](H& h) { h.epoch = id_after(-9999); }),
      spoiled("HeartbeatOfALaterEpoch", heartbeat(2), R::kStale,
              [](H& h) { h.epoch = id_after(0); }),
      spoiled("HeartbeatAgain", heartbeat(2), R::kDuplicate, [](H& h) { h = heartbeat(1); }),
      spoiled("HeartbeatOfAFutureEpoch", heartbeat(2), R::kForged, [](H& h) { h.epoch = kHuge; }),
      spoiled("HeartbeatHugeNumber", heartbeat(2), R::kForged,
              [](H& h) { h.sequence_number = kHuge; }),
      spoiled("HeartbeatOfTheFuture", heartbeat(2), R::kForged,
              [](H& h) { h.stamp_utc_ns = ns_after(60); }),
  };
}

std::vector<Case> command_cases() {
  using R = RefusalReason;
  using C = CommandMessage;
  return {
      spoiled("CommandOfAnotherSchema", command(2), R::kSchema,
              [](C& c) { c.schema_version = 99; }),
      spoiled("CommandNoKind", command(2), R::kOutOfRange,
              [](C& c) { c.kind = static_cast<CommandKind>(77); }),
      spoiled("CommandOlder", command(2), R::kStale, [](C& c) { c.command_id = 1; }),
      spoiled("CommandAgain", command(2), R::kDuplicate,
              [](C& c) { c.command_id = command(1).command_id; }),
      spoiled("CommandHugeId", command(2), R::kForged, [](C& c) { c.command_id = kHuge; }),
      spoiled("CommandOfTheFuture", command(2), R::kForged,
              [](C& c) { c.stamp_utc_ns = ns_after(60); }),
  };
}

std::vector<Case> status_cases() {
  using R = RefusalReason;
  using S = StatusMessage;
  return {
      spoiled("StatusOfAnotherSchema", status(2), R::kSchema, [](S& s) { s.schema_version = 99; }),
      spoiled("StatusTooLong", status(2), R::kOversized, [](S& s) { s.robots.resize(101); }),
      spoiled("StatusNotFinite", status(2), R::kNotFinite, [](S& s) { s.robots[0].x_m = kNaN; }),
      spoiled("StatusOutsideTheMap", status(2), R::kOutOfRange,
              [](S& s) { s.robots[0].x_m = 1e6; }),
      spoiled("StatusOfAStranger", status(2), R::kOutOfRange,
              [](S& s) { s.robots[0].robot_id = 12; }),
      spoiled("StatusOfAStrangeProcess", status(2), R::kOutOfRange,
              [](S& s) { s.first_robot_id = 12; }),
      spoiled("StatusNoMode", status(2), R::kOutOfRange,
              [](S& s) { s.robots[0].mode = static_cast<RobotMode>(9); }),
      spoiled("StatusOfTheFuture", status(2), R::kClockSkew,
              [](S& s) { s.stamp_utc_ns = ns_after(60); }),
      spoiled("StatusOfAFutureEpoch", status(2), R::kForged, [](S& s) { s.plan_epoch = kHuge; }),
      spoiled("StatusOfAFutureScene", status(2), R::kForged,
              [](S& s) { s.plan_scene_version = kHuge; }),
  };
}

std::vector<Case> event_cases() {
  using R = RefusalReason;
  using E = EventMessage;
  std::vector<Case> cases = {
      spoiled("EventOfAnotherSchema", event(2), R::kSchema, [](E& e) { e.schema_version = 99; }),
      spoiled("EventTooLong", event(2), R::kOversized, [](E& e) { e.text.assign(513, 'a'); }),
      spoiled("EventThatSteersATerminal", event(2), R::kOutOfRange,
              [](E& e) { e.text = "\x1b[2J"; }),
      spoiled("EventOfAStranger", event(2), R::kOutOfRange, [](E& e) { e.source = 12; }),
      spoiled("EventInTheLaunchersName", event(2), R::kForged,
              [](E& e) { e.source = kLauncherSource; }),
  };
  cases[1].only = "Launcher";  // the monitor's decoder cuts texts
  cases[4].only = "Launcher";
  return cases;
}

std::vector<Case> state_cases() {
  using R = RefusalReason;
  using S = RobotStateMessage;
  const auto state = [](const std::string& name, R reason, auto spoil) {
    return spoiled(name, batch(2), reason, [&](CellStatesMessage& b) { spoil(b.states[0]); });
  };
  std::vector<Case> cases = {
      spoiled("BatchOfAnotherSchema", batch(2), R::kSchema,
              [](CellStatesMessage& b) { b.schema_version = 99; }),
      spoiled("BatchTooLong", batch(2), R::kOversized,
              [](CellStatesMessage& b) { b.states.resize(257, b.states[0]); }),
      state("StateNotFinite", R::kNotFinite, [](S& s) { s.x_m = kNaN; }),
      state("StateOutsideTheMap", R::kOutOfRange, [](S& s) { s.x_m = 1e6; }),
      state("StateTooFast", R::kOutOfRange, [](S& s) { s.vx_mps = 50; }),
      state("StateOfAStranger", R::kOutOfRange, [](S& s) { s.robot_id = 4'000'000'000; }),
      state("StateNoMode", R::kOutOfRange, [](S& s) { s.mode = static_cast<RobotMode>(200); }),
      state("StateOfTheFuture", R::kClockSkew, [](S& s) { s.stamp_utc_ns = ns_after(60); }),
      state("StateOfLongAgo", R::kClockSkew, [](S& s) { s.stamp_utc_ns = ns_after(-60); }),
      state("StateInOurName", R::kForged, [](S& s) { s.robot_id = kOwnRobot; }),
      state("StateAgain", R::kDuplicate, [](S& s) { s = batch(1).states[0]; }),
      state("StateOlder", R::kStale, [](S& s) { s.stamp_utc_ns = ns_after(-5); }),
  };
  cases[9].only = "Agent";
  cases[10].only = cases[11].only = "Gateway";  // the others' tables keep the newest of each robot
  return cases;
}

}  // namespace

AnyMessage good(std::size_t topic, int n) {
  const std::vector<AnyMessage> messages = {plan(n),   scene(n), heartbeat(n), command(n),
                                            status(n), event(n), batch(n)};
  return messages[topic];
}

std::vector<Case> all_cases(const Basis& of) {
  basis = of;
  std::vector<Case> all;
  for (const auto& cases : {plan_cases(), scene_cases(), heartbeat_cases(), command_cases(),
                            status_cases(), event_cases(), state_cases()}) {
    all.insert(all.end(), cases.begin(), cases.end());
  }
  return all;
}

}  // namespace swarm::link::conformance
