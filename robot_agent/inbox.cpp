// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/inbox.hpp"

#include <algorithm>
#include <utility>

#include "swarm_core/base/stamp.hpp"

namespace swarm::agent {

namespace {

// A state older than this on receipt, after the time it waited for our tick, has a wrong stamp.
constexpr Duration kLatePlausible = std::chrono::seconds(1);

}  // namespace

Inbox::Inbox(Readers readers, link::StateChannel& states, const link::WireLimits& limits,
             const MissionWatch& mission, Duration planner_silence, double communication_radius_m)
    : readers_(std::move(readers)),
      states_(states),
      limits_(limits),
      mission_(mission),
      plan_time_(planner_silence),
      gate_({.limits = limits}),
      received_cells_(communication_radius_m) {}

/// Keeps only the newest plan that passes the gate. A plan of the same digest is the same flow
/// under another version: the plan's clock goes on.
void Inbox::receive_plans(UtcTime utc_now) {
  plans_.clear();
  readers_.plan->take(plans_);
  for (link::PlanMessage& message : plans_) receive_plan(message, utc_now);
}

/// A plan of a planner that does not rule is kept, see WaitingPlan.
void Inbox::receive_plan(link::PlanMessage& message, UtcTime utc_now) {
  auto plan = gate_.plan(message, utc_now);
  if (!plan) {
    waiting_plan_.keep(std::move(message), plan.error(), gate_.planner_epoch());
    return;
  }
  plan_time_.on_plan(message.version, plan->digest() == plan_digest_);
  plan_digest_ = plan->digest();
  new_plan_ = {std::move(*plan), std::move(message.entries)};
  plan_epoch_ = message.epoch;
  plan_version_ = message.version;
  plan_scene_version_ = message.scene_version;
}

/// Its sender rules since the last heartbeat.
void Inbox::take_waiting_plan(UtcTime utc_now) {
  if (auto message = waiting_plan_.take(gate_.planner_epoch())) receive_plan(*message, utc_now);
}

void Inbox::receive_scenes(UtcTime utc_now) {
  scenes_.clear();
  readers_.scene->take(scenes_);
  for (const link::SceneMessage& message : scenes_) {
    auto scene = gate_.scene(message, utc_now);
    // Version 0 is the scene of the mission file, with which the agent began.
    if (scene && scene->version > 0) new_scene_ = std::move(*scene);
  }
}

void Inbox::receive_heartbeats(SteadyTime now, UtcTime utc_now) {
  heartbeats_.clear();
  readers_.heartbeat->take(heartbeats_);
  for (const link::HeartbeatMessage& beat : heartbeats_) {
    if (!gate_.heartbeat(beat, utc_now)) continue;
    take_waiting_plan(utc_now);
    mission_.on_heartbeat(now);
    plan_time_.on_heartbeat({.version = beat.version,
                             .plan_time_s = beat.plan_time_s,
                             .rate = beat.plan_rate,
                             .stamp_utc_ns = beat.stamp_utc_ns},
                            now);
  }
}

/// The stamp of the stop command is kept for the log: it measures how long a stop takes.
void Inbox::receive(const link::CommandMessage& command, UtcTime utc_now) {
  if (!gate_.command(command, utc_now)) return;
  const MissionPhase before = mission_.phase();
  mission_.on_command(command.kind);
  command_id_ = std::max(command_id_, command.command_id);
  if (mission_.phase() == MissionPhase::kStopped && before != MissionPhase::kStopped) {
    stop_stamp_utc_ns_ = to_stamp(command.stamp_utc_ns);  // a stop passes with any stamp
  }
}

void Inbox::receive_commands(UtcTime utc_now) {
  commands_.clear();
  readers_.command->take(commands_);
  for (const link::CommandMessage& command : commands_) receive(command, utc_now);
}

/// Plans before heartbeats, so that a heartbeat of a plan received at the same tick counts at once.
void Inbox::receive_fixed_topics(SteadyTime now, UtcTime utc_now) {
  if (!began_) began_ = utc_now;
  receive_plans(utc_now);
  receive_scenes(utc_now);
  receive_heartbeats(now, utc_now);
  receive_commands(utc_now);
  gate_.set_undecodable(readers_.plan->undecodable() + readers_.scene->undecodable() +
                        readers_.heartbeat->undecodable() + readers_.command->undecodable() +
                        states_.undecodable() + undecodable_stops_);
}

void Inbox::begin_states() {
  received_.clear();
  batches_.clear();
  states_.take(batches_);
}

/// A restarted robot may still receive states of the process before it: those are older.
void Inbox::note_duplicate(const link::RobotStateMessage& state, UtcTime utc_now) {
  const bool is_older = UtcTime(Duration(state.stamp_utc_ns)) <= began_.value_or(utc_now);
  if (!duplicate_id_ && !is_older) duplicate_id_ = RobotId(state.robot_id);
}

/// Checks one state and gives it a time on our steady clock: receipt minus the age by its stamp.
void Inbox::receive_state(const link::RobotStateMessage& state, SteadyTime steady_now,
                          UtcTime utc_now, const EchoGuard* own) {
  if (const auto checked = gate_.state(state, utc_now, own); !checked) {
    if (own != nullptr && checked.error() == link::RefusalReason::kForged) {
      note_duplicate(state, utc_now);
    }
    return;
  }
  // A state may have waited in the socket since our last tick, however long ago that is, and have
  // been late before that. One that is older still, or comes from the future, has a stamp by a
  // clock that is off: it counts as received right after the last tick.
  const Duration waited = received_before_ ? steady_now - *received_before_ : Duration::zero();
  Duration age = utc_now - UtcTime(Duration(state.stamp_utc_ns));
  if (age < -limits_.clock_skew_warn || age > waited + kLatePlausible) {
    ++skewed_;
    age = waited;
  }
  age = std::max(age, Duration::zero());
  received_.push_back({.report = {.robot = RobotId(state.robot_id),
                                  .sequence = state.sequence_number,
                                  .as_of = steady_now - age,
                                  .position_m = {state.x_m, state.y_m},
                                  .velocity_mps = {state.vx_mps, state.vy_mps}},
                       .age = age});
}

}  // namespace swarm::agent
