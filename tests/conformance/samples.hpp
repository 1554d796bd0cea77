// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <string>

#include "swarm_link/messages.hpp"
#include "swarm_link/topics.hpp"
#include "swarmflow/core/random.hpp"

/// Messages with every field set to something of its own.
namespace swarm::link::conformance {

template <class M>
M sample(Rng& rng);

/// The topic that carries a message.
template <class M>
Topic<M> topic_of();

inline double number(Rng& rng) { return uniform(rng, -1e3, 1e3); }

template <class Integer>
Integer integer(Rng& rng) {
  return static_cast<Integer>(rng());
}

inline PlanMessage plan_of_size(Rng& rng, std::size_t nodes, std::size_t legs) {
  PlanMessage plan{.version = integer<std::uint32_t>(rng),
                   .epoch = integer<std::uint64_t>(rng),
                   .scene_version = integer<std::uint64_t>(rng),
                   .t0_utc_ns = integer<std::int64_t>(rng),
                   .excess_m = number(rng)};
  for (std::size_t i = 0; i < nodes; ++i) {
    plan.nodes.push_back({number(rng), number(rng), number(rng), number(rng), number(rng),
                          number(rng), number(rng)});
  }
  for (std::size_t i = 0; i < legs; ++i) {
    plan.legs.push_back({integer<std::uint32_t>(rng), integer<std::uint32_t>(rng), number(rng)});
  }
  for (int i = 0; i < 7; ++i)
    plan.entries.push_back({integer<std::uint16_t>(rng), integer<std::uint16_t>(rng)});
  return plan;
}

template <>
inline PlanMessage sample<PlanMessage>(Rng& rng) {
  return plan_of_size(rng, 3, 5);
}

template <>
inline SceneMessage sample<SceneMessage>(Rng& rng) {
  SceneMessage scene{.version = integer<std::uint64_t>(rng),
                     .risk_alpha = number(rng),
                     .next_id = integer<std::uint32_t>(rng)};
  for (int i = 0; i < 3; ++i) {
    scene.removed.push_back(integer<std::uint32_t>(rng));
    scene.obstacles.push_back({.obstacle_id = integer<std::uint32_t>(rng),
                               .owner_robot_id = integer<std::uint32_t>(rng),
                               .vertices = integer<std::uint32_t>(rng),
                               .center = {number(rng), number(rng)},
                               .radius_m = number(rng),
                               .velocity_x_mps = number(rng),
                               .velocity_y_mps = number(rng),
                               .moving_from_utc_ns = integer<std::int64_t>(rng),
                               .moving_until_utc_ns = integer<std::int64_t>(rng)});
    scene.vertices.push_back({number(rng), number(rng)});
    scene.goal.push_back(
        {number(rng), number(rng), number(rng), number(rng), number(rng), number(rng)});
  }
  return scene;
}

template <>
inline HeartbeatMessage sample<HeartbeatMessage>(Rng& rng) {
  return {.phase = MissionPhase::kPaused,
          .version = integer<std::uint32_t>(rng),
          .epoch = integer<std::uint64_t>(rng),
          .sequence_number = integer<std::uint64_t>(rng),
          .stamp_utc_ns = integer<std::int64_t>(rng),
          .mission_time_s = number(rng),
          .plan_time_s = number(rng),
          .plan_rate = number(rng)};
}

template <>
inline CellStatesMessage sample<CellStatesMessage>(Rng& rng) {
  CellStatesMessage batch{.cell_x = integer<std::int32_t>(rng),
                          .cell_y = integer<std::int32_t>(rng)};
  for (std::size_t i = 0; i < kMaxCellStates; ++i) {
    batch.states.push_back({.robot_id = integer<std::uint32_t>(rng),
                            .sequence_number = integer<std::uint32_t>(rng),
                            .stamp_utc_ns = integer<std::int64_t>(rng),
                            .x_m = number(rng),
                            .y_m = number(rng),
                            .vx_mps = number(rng),
                            .vy_mps = number(rng),
                            .mode = RobotMode::kArrived});
  }
  return batch;
}

template <>
inline CommandMessage sample<CommandMessage>(Rng& rng) {
  return {.kind = CommandKind::kResume,
          .command_id = integer<std::uint64_t>(rng),
          .stamp_utc_ns = integer<std::int64_t>(rng)};
}

template <>
inline RobotStatusMessage sample<RobotStatusMessage>(Rng& rng) {
  return {.robot_id = integer<std::uint32_t>(rng),
          .mode = RobotMode::kStopped,
          .arrived = true,
          .settled = true,
          .x_m = number(rng),
          .y_m = number(rng),
          .remaining_m = number(rng),
          .lag_s = number(rng),
          .nearest_gap_m = number(rng),
          .neighbours_heard = integer<std::uint32_t>(rng),
          .ticks = integer<std::uint32_t>(rng),
          .late_ticks = integer<std::uint32_t>(rng),
          .states_sent = integer<std::uint32_t>(rng),
          .states_received = integer<std::uint32_t>(rng)};
}

template <>
inline StatusMessage sample<StatusMessage>(Rng& rng) {
  StatusMessage status{.first_robot_id = integer<std::uint32_t>(rng),
                       .process_id = integer<std::uint32_t>(rng),
                       .plan_version = integer<std::uint32_t>(rng),
                       .plan_epoch = integer<std::uint64_t>(rng),
                       .plan_scene_version = integer<std::uint64_t>(rng),
                       .command_id = integer<std::uint64_t>(rng),
                       .stamp_utc_ns = integer<std::int64_t>(rng),
                       .plan_time_s = number(rng)};
  for (int i = 0; i < 100; ++i) status.robots.push_back(sample<RobotStatusMessage>(rng));
  for (int i = 0; i < 16; ++i) status.refused.push_back(integer<std::uint32_t>(rng));
  for (std::uint16_t i = 0; i < 464; ++i) {
    status.state_age.push_back({.bin = i, .count = integer<std::uint32_t>(rng)});
  }
  return status;
}

template <>
inline EventMessage sample<EventMessage>(Rng& rng) {
  return {.severity = Severity::kError,
          .source = integer<std::uint32_t>(rng),
          .stamp_utc_ns = integer<std::int64_t>(rng),
          .code = std::string(64, 'c'),
          .text = std::string(512, 't')};
}

template <>
inline Topic<PlanMessage> topic_of<PlanMessage>() {
  return plan_topic();
}
template <>
inline Topic<SceneMessage> topic_of<SceneMessage>() {
  return scene_topic();
}
template <>
inline Topic<HeartbeatMessage> topic_of<HeartbeatMessage>() {
  return heartbeat_topic();
}
template <>
inline Topic<CellStatesMessage> topic_of<CellStatesMessage>() {
  return cell_topic({-3, 14});
}
template <>
inline Topic<CommandMessage> topic_of<CommandMessage>() {
  return command_topic();
}
template <>
inline Topic<StatusMessage> topic_of<StatusMessage>() {
  return status_topic();
}
template <>
inline Topic<EventMessage> topic_of<EventMessage>() {
  return event_topic();
}

}  // namespace swarm::link::conformance
