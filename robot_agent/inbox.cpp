// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_agent/inbox.hpp"

#include <algorithm>
#include <utility>

namespace swarm::agent {

using link::RefusalReason;

namespace {

constexpr Duration kLatePlausible = std::chrono::seconds(1);

}  // namespace

Inbox::Inbox(Readers readers, link::StateChannel& states, const link::WireLimits& limits,
             const MissionWatch& mission, Duration planner_silence, double hear_radius_m)
    : readers_(std::move(readers)),
      states_(states),
      limits_(limits),
      mission_(mission),
      plan_time_(planner_silence),
      heard_cells_(hear_radius_m) {}

void Inbox::receive_plans(std::uint64_t newest) {
  plans_.clear();
  readers_.plan->take(plans_);
  for (link::PlanMessage& message : plans_) {
    auto plan = link::check_plan(message, limits_);
    if (!plan) {
      refused_.count(plan.error());
    } else if (message.epoch > newest) {
      refused_.count(RefusalReason::kForged);
    } else if (!plan_sequence_.accept({message.epoch, message.version})) {
      refused_.count(RefusalReason::kStale);
    } else {
      plan_time_.on_plan(message.version, plan->digest() == plan_digest_);
      plan_digest_ = plan->digest();
      new_plan_ = {std::move(*plan), std::move(message.entries)};
      plan_epoch_ = message.epoch;
      plan_version_ = message.version;
      plan_scene_version_ = message.scene_version;
    }
  }
}

void Inbox::receive_scenes(std::uint64_t newest) {
  scenes_.clear();
  readers_.scene->take(scenes_);
  for (const link::SceneMessage& message : scenes_) {
    auto scene = link::check_scene(message, limits_);
    if (!scene) {
      refused_.count(scene.error());
    } else if (scene->version > newest) {
      refused_.count(RefusalReason::kForged);
    } else if (scene->version < scene_version_) {
      refused_.count(RefusalReason::kStale);
    } else if (scene->version > scene_version_) {  // 0 is known: the mission file
      scene_version_ = scene->version;
      new_scene_ = std::move(*scene);
    }
  }
}

void Inbox::receive_fixed_topics(SteadyTime now, UtcTime utc_now) {
  // Epochs, scene versions and command ids are UTC stamps of their makers: one from the future is
  // forged, and would lock everyone out if it were believed.
  const auto newest =
      static_cast<std::uint64_t>((utc_now + limits_.clock_skew_refuse).time_since_epoch().count());
  receive_plans(newest);
  receive_scenes(newest);

  heartbeats_.clear();
  readers_.heartbeat->take(heartbeats_);
  for (const link::HeartbeatMessage& beat : heartbeats_) {
    if (const auto ok = link::check_heartbeat(beat); !ok) {
      refused_.count(ok.error());
    } else if (beat.epoch > newest) {
      refused_.count(RefusalReason::kForged);
    } else if (std::pair(beat.epoch, beat.sequence_number) <=
               std::pair(heartbeat_epoch_, last_heartbeat_)) {
      refused_.count(RefusalReason::kStale);
    } else {
      heartbeat_epoch_ = beat.epoch;
      last_heartbeat_ = beat.sequence_number;
      mission_.on_heartbeat(now);
      plan_time_.on_heartbeat({.version = beat.version,
                               .plan_time_s = beat.plan_time_s,
                               .rate = beat.plan_rate,
                               .stamp_utc_ns = beat.stamp_utc_ns},
                              now);
    }
  }

  commands_.clear();
  readers_.command->take(commands_);
  for (const link::CommandMessage& command : commands_) {
    if (const auto ok = link::check_command(command); !ok) {
      refused_.count(ok.error());
      continue;
    }
    if (command.command_id > newest) {
      refused_.count(RefusalReason::kForged);
      continue;
    }
    const auto outcome = mission_.on_command(command.kind, command.command_id);
    if (outcome == MissionWatch::Outcome::kStale) refused_.count(RefusalReason::kStale);
    if (outcome == MissionWatch::Outcome::kObeyed && command.kind == CommandKind::kStop) {
      stop_stamp_utc_ns_ = command.stamp_utc_ns;
    }
  }

  const std::uint64_t undecodable = readers_.plan->undecodable() + readers_.scene->undecodable() +
                                    readers_.heartbeat->undecodable() +
                                    readers_.command->undecodable() + states_.undecodable();
  refused_.count(RefusalReason::kUndecodable,
                 static_cast<std::uint32_t>(undecodable - undecodable_seen_));
  undecodable_seen_ = undecodable;
}

void Inbox::begin_states() {
  heard_.clear();
  batches_.clear();
  states_.take(batches_);
}

void Inbox::receive_state(const link::RobotStateMessage& state, SteadyTime steady_now,
                          UtcTime utc_now, const EchoGuard* own) {
  if (const auto ok = link::check_state(state, limits_, utc_now); !ok) {
    refused_.count(ok.error());
    return;
  }
  if (own != nullptr && !own->is_echo(state)) {
    refused_.count(RefusalReason::kForged);
    return;
  }
  // A state may have waited in the socket since our last tick, however long ago that is, and have
  // been late before that. What is older still, or comes from the future, has a clock that is off:
  // the state counts as old as it may be.
  const Duration waited = received_before_ ? steady_now - *received_before_ : Duration::zero();
  Duration age = utc_now - UtcTime(Duration(state.stamp_utc_ns));
  if (age < -limits_.clock_skew_warn || age > waited + kLatePlausible) {
    ++skewed_;
    age = waited;
  }
  age = std::max(age, Duration::zero());
  heard_.push_back({.report = {.robot = RobotId(state.robot_id),
                               .sequence = state.sequence_number,
                               .as_of = steady_now - age,
                               .position_m = {state.x_m, state.y_m},
                               .velocity_mps = {state.vx_mps, state.vy_mps}},
                    .age = age});
}

}  // namespace swarm::agent
