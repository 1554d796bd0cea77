// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/swarm_state.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "swarm_link/event_words.hpp"

namespace swarm::monitor {
namespace {

/// Robots say something twice a second; after this they are taken for lost.
constexpr Duration kLostAfter = std::chrono::seconds(3);
/// A state is carried on this long at most.
constexpr double kCarryOn_s = 0.8;
/// Who hears nobody tells of a gap that is larger than any map.
constexpr double kNobodyNear_m = 1e8;
constexpr std::size_t kMostEvents = 100'000;

}  // namespace

SwarmState::SwarmState(const Mission& mission)
    : gate_({.limits = link::wire_limits(mission), .stamps = link::Stamps::kRecorded}),
      robots_(mission.robots.count),
      scene_(first_scene(mission.world.obstacles().size())),
      meter_(mission.robots.count) {}

void SwarmState::take(const TappedSample& sample) {
  const std::string& topic = recorded_topics()[sample.topic].name;
  if (sample.topic == states_index()) {
    take_states(sample);
  } else if (topic == "swarm/status") {
    take_status(sample);
  } else if (topic == "swarm/plan") {
    take_plan(sample);
  } else if (topic == "swarm/scene") {
    take_scene(sample);
  } else if (topic == "swarm/heartbeat") {
    take_heartbeat(sample);
  } else if (topic == "swarm/command") {
    take_command(sample);
  } else if (topic == "swarm/event") {
    take_event(sample);
  }
}

template <class M>
bool SwarmState::decode(link::Codec<M>& codec, const TappedSample& sample, M& out) {
  auto* bytes = reinterpret_cast<std::byte*>(const_cast<unsigned char*>(sample.bytes.data()));
  const bool decoded = codec.decode({bytes, sample.bytes.size()}, out);
  if (!decoded) gate_.set_undecodable(++undecodable_);
  return decoded;
}

void SwarmState::take_states(const TappedSample& sample) {
  if (!decode(states_codec_, sample, states_)) return;
  if (!gate_.batch(states_)) return;
  for (const link::RobotStateMessage& state : states_.states) {
    if (!gate_.state(state, sample.heard)) continue;
    if (!begin_) begin_ = sample.heard;
    meter_.hear(state, sample.heard);
    Robot& robot = robots_[state.robot_id];
    robot.heard_of = true;
    robot.heard = robot.moved = sample.heard;
    robot.position_m = {state.x_m, state.y_m};
    robot.velocity_mps = {state.vx_mps, state.vy_mps};
    robot.mode = state.mode;
    robot.arrived = state.mode == RobotMode::kArrived;
  }
}

void SwarmState::take_status(const TappedSample& sample) {
  if (!decode(status_codec_, sample, status_)) return;
  if (!gate_.status(status_, sample.heard)) return;
  for (const link::RobotStatusMessage& status : status_.robots) {
    Robot& robot = robots_[status.robot_id];
    // Where it is its states tell better, if there are any.
    if (!robot.heard_of) robot.position_m = {status.x_m, status.y_m};
    robot.heard_of = true;
    robot.heard = sample.heard;
    robot.mode = status.mode;
    robot.arrived = status.arrived;
    robot.nearest_gap_m = status.nearest_gap_m < kNobodyNear_m
                              ? status.nearest_gap_m
                              : std::numeric_limits<double>::infinity();
    robot.neighbours = status.neighbours_heard;
    robot.ticks = status.ticks;
    robot.late_ticks = status.late_ticks;
  }
}

void SwarmState::take_plan(const TappedSample& sample) {
  link::PlanMessage message;
  if (!decode(plan_codec_, sample, message)) return;
  auto plan = gate_.plan(message, sample.heard);
  if (!plan) return;
  plan_ = std::move(*plan);
  plan_version_ = message.version;
  plan_excess_m_ = std::max(plan_excess_m_, message.excess_m);
  ++version_;
}

void SwarmState::take_scene(const TappedSample& sample) {
  link::SceneMessage message;
  if (!decode(scene_codec_, sample, message)) return;
  auto scene = gate_.scene(message, sample.heard);
  // Version 0 is the mission file's, which is shown from the beginning.
  if (!scene || scene->version == 0) return;
  scene_ = std::move(*scene);
  ++version_;
}

void SwarmState::take_heartbeat(const TappedSample& sample) {
  link::HeartbeatMessage message;
  if (!decode(heartbeat_codec_, sample, message)) return;
  if (!gate_.heartbeat(message, sample.heard)) return;
  phase_ = message.phase;
  mission_time_s_ = message.mission_time_s;
  plan_time_s_ = message.plan_time_s;
  plan_rate_ = message.plan_rate;
  beat_at_ = sample.heard;
}

void SwarmState::take_command(const TappedSample& sample) {
  // Nothing of a command is shown but that it was refused; what it does, heartbeats report.
  link::CommandMessage message;
  if (decode(command_codec_, sample, message)) (void)gate_.command(message, sample.heard);
}

void SwarmState::take_event(const TappedSample& sample) {
  link::EventMessage message;
  if (!decode(event_codec_, sample, message)) return;
  if (!gate_.event(message) || events_.size() == kMostEvents) return;
  events_.push_back({.time_s = begin_ ? to_seconds(sample.heard - *begin_) : 0.0,
                     .source = link::source_name(message.source),
                     .severity = std::string(link::to_string(message.severity)),
                     .code = message.code,
                     .text = message.text});
}

Vec2 SwarmState::position_of(const Robot& robot, UtcTime now) const {
  const double age_s = std::clamp(to_seconds(now - robot.moved), 0.0, kCarryOn_s);
  return robot.position_m + age_s * robot.velocity_mps;
}

bool SwarmState::is_lost(const Robot& robot, UtcTime now) const {
  return robot.heard_of && now - robot.heard > kLostAfter;
}

SwarmState::Counts SwarmState::counts(UtcTime now) const {
  Counts counts{.nearest_gap_m = std::numeric_limits<double>::infinity()};
  for (const Robot& robot : robots_) {
    if (!robot.heard_of) continue;
    ++counts.heard;
    counts.moving += robot.mode == RobotMode::kMoving ? 1 : 0;
    counts.arrived += robot.arrived ? 1 : 0;
    counts.lost += is_lost(robot, now) ? 1 : 0;
    counts.nearest_gap_m = std::min(counts.nearest_gap_m, robot.nearest_gap_m);
  }
  return counts;
}

double SwarmState::plan_time_s(UtcTime now) const {
  return plan_time_s_ + plan_rate_ * std::clamp(to_seconds(now - beat_at_), 0.0, 1.0);
}

double SwarmState::mission_time_s(UtcTime now) const {
  if (phase_ != MissionPhase::kRunning) return mission_time_s_;
  return mission_time_s_ + std::clamp(to_seconds(now - beat_at_), 0.0, 1.0);
}

}  // namespace swarm::monitor
