// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/view/swarm_state.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swarm::monitor {
namespace {

/// A robot that is silent for this long counts as lost: each one publishes at least twice a second.
constexpr Duration kLostAfter = std::chrono::seconds(3);
/// Longest extrapolation of a state; after that the robot is shown where it stopped being received.
constexpr double kCarryOn_s = 0.8;
constexpr std::size_t kMostEvents = 100'000;

}  // namespace

SwarmState::SwarmState(const Mission& mission, link::Stamps stamps)
    : reader_(mission, *this, stamps),
      robots_(mission.robots.count),
      scene_(first_scene(mission.world.obstacles().size())),
      meter_(mission.robots.count) {}

/// States carry motion: they update position and velocity and count in the stream's statistics.
void SwarmState::on_state(const ObservedState& state) {
  if (!begin_) begin_ = state.received;
  meter_.receive({.robot_id = state.robot.value(),
                  .sequence_number = state.sequence,
                  .stamp_utc_ns = state.stamp.time_since_epoch().count()},
                 state.received);
  Robot& robot = robots_[state.robot.value()];
  robot.was_received = true;
  robot.received = robot.moved = state.received;
  robot.position_m = state.position_m;
  robot.velocity_mps = state.velocity_mps;
  robot.mode = state.mode;
  robot.arrived = state.mode == RobotMode::kArrived;
}

void SwarmState::on_status(const ObservedStatus& status) {
  Robot& robot = robots_[status.robot.value()];
  // States update the position more often; a status sets it only before the first state.
  if (!robot.was_received) robot.position_m = status.position_m;
  robot.was_received = true;
  robot.received = status.received;
  robot.mode = status.mode;
  robot.arrived = status.arrived;
  robot.nearest_gap_m = status.nearest_gap_m;
  robot.neighbours = status.neighbours;
  robot.ticks = status.ticks;
  robot.late_ticks = status.late_ticks;
}

void SwarmState::on_plan(const ObservedPlan& plan) {
  plan_ = plan.flow;
  plan_version_ = plan.version;
  plan_excess_m_ = std::max(plan_excess_m_, plan.excess_m);
  ++version_;
}

void SwarmState::on_scene(const Scene& scene) {
  scene_ = scene;
  ++version_;
}

/// The values at the last heartbeat; between heartbeats plan_time_s() and mission_time_s()
/// extrapolate.
void SwarmState::on_clock(const ObservedClock& clock) {
  phase_ = clock.phase;
  mission_time_s_ = clock.mission_time_s;
  plan_time_s_ = clock.plan_time_s;
  plan_rate_ = clock.plan_rate;
  beat_at_ = clock.received;
  beat_stamp_ = clock.stamp;
}

/// The mission time follows from the newest heartbeat. It stays unknown before the first one and
/// for old events, which a monitor that joins late receives: a pause may lie between.
void SwarmState::on_event(const ObservedEvent& event) {
  constexpr double kRecent_s = 2.0;
  if (events_.size() == kMostEvents) return;
  std::optional<double> at_s;
  if (beat_stamp_) {
    // In doubles: stamps of other hosts are not bounded, and their difference might overflow.
    const double since_beat_s =
        to_seconds(event.stamp.time_since_epoch()) - to_seconds(beat_stamp_->time_since_epoch());
    const double time_s =
        phase_ == MissionPhase::kRunning ? mission_time_s_ + since_beat_s : mission_time_s_;
    if (std::abs(since_beat_s) < kRecent_s) at_s = std::max(0.0, time_s);
  }
  events_.push_back({.time_s = begin_ ? to_seconds(event.received - *begin_) : 0.0,
                     .source = event.source,
                     .severity = event.severity,
                     .code = event.code,
                     .text = event.text,
                     .mission_time_s = at_s});
}

/// Linear extrapolation from the last state, as the robot's neighbours do it.
Vec2 SwarmState::position_of(const Robot& robot, UtcTime now) const {
  const double age_s = std::clamp(to_seconds(now - robot.moved), 0.0, kCarryOn_s);
  return robot.position_m + age_s * robot.velocity_mps;
}

bool SwarmState::is_lost(const Robot& robot, UtcTime now) const {
  return robot.was_received && now - robot.received > kLostAfter;
}

SwarmState::Counts SwarmState::counts(UtcTime now) const {
  Counts counts{.nearest_gap_m = std::numeric_limits<double>::infinity()};
  for (const Robot& robot : robots_) {
    if (!robot.was_received) continue;
    ++counts.received;
    counts.moving += robot.mode == RobotMode::kMoving ? 1 : 0;
    counts.arrived += robot.arrived ? 1 : 0;
    counts.lost += is_lost(robot, now) ? 1 : 0;
    counts.nearest_gap_m = std::min(counts.nearest_gap_m, robot.nearest_gap_m);
  }
  return counts;
}

/// τ at the last heartbeat plus rate · age, for at most one second: a silent planner's clock is not
/// continued for ever.
double SwarmState::plan_time_s(UtcTime now) const {
  return plan_time_s_ + plan_rate_ * std::clamp(to_seconds(now - beat_at_), 0.0, 1.0);
}

/// Mission time advances only while the mission runs.
double SwarmState::mission_time_s(UtcTime now) const {
  if (phase_ != MissionPhase::kRunning) return mission_time_s_;
  return mission_time_s_ + std::clamp(to_seconds(now - beat_at_), 0.0, 1.0);
}

}  // namespace swarm::monitor
