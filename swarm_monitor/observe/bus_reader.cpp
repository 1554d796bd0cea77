// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_monitor/observe/bus_reader.hpp"

#include <limits>
#include <string>
#include <utility>

#include "swarm_link/cdr/codec.hpp"
#include "swarm_link/event_names.hpp"

namespace swarm::monitor {
namespace {

/// Gaps from here on mean "no neighbour": the wire has no infinity, so that such a robot reports a
/// gap larger than any map.
constexpr double kNoNeighbour_m = 1e8;

}  // namespace

BusReader::BusReader(const Mission& mission, Observer& observer, link::Stamps stamps)
    : gate_({.limits = link::wire_limits(mission), .stamps = stamps}), observer_(observer) {}

/// Dispatch by topic. The index of states is compared first, because states are most of the
/// traffic.
void BusReader::take(const TappedSample& sample) {
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

/// Messages that are not valid CDR of their type count as refused, like those that the gate
/// refuses.
template <class M>
bool BusReader::decode(const TappedSample& sample, M& out) {
  const bool decoded = link::decode(std::as_bytes(sample.bytes), out);
  if (!decoded) gate_.set_undecodable(++undecodable_);
  return decoded;
}

/// A batch holds the states of several robots; each is checked on its own, so one bad state does
/// not hide the others.
void BusReader::take_states(const TappedSample& sample) {
  if (!decode(sample, states_) || !gate_.batch(states_)) return;
  for (const link::RobotStateMessage& state : states_.states) {
    if (!gate_.state(state, sample.received)) continue;
    observer_.on_state({.robot = RobotId(state.robot_id),
                        .sequence = state.sequence_number,
                        .stamp = UtcTime(Duration(state.stamp_utc_ns)),
                        .received = sample.received,
                        .position_m = {state.x_m, state.y_m},
                        .velocity_mps = {state.vx_mps, state.vy_mps},
                        .mode = state.mode});
  }
}

void BusReader::take_status(const TappedSample& sample) {
  if (!decode(sample, status_) || !gate_.status(status_, sample.received)) return;
  for (const link::RobotStatusMessage& status : status_.robots) {
    observer_.on_status({.robot = RobotId(status.robot_id),
                         .received = sample.received,
                         .position_m = {status.x_m, status.y_m},
                         .mode = status.mode,
                         .arrived = status.arrived,
                         .remaining_m = status.remaining_m,
                         .lag_s = status.lag_s,
                         .nearest_gap_m = status.nearest_gap_m < kNoNeighbour_m
                                              ? status.nearest_gap_m
                                              : std::numeric_limits<double>::infinity(),
                         .neighbours = status.neighbours_heard,
                         .ticks = status.ticks,
                         .late_ticks = status.late_ticks});
  }
}

/// Observers get a reference to the reader's own copy, valid until the next plan.
void BusReader::take_plan(const TappedSample& sample) {
  link::PlanMessage message;
  if (decode(sample, message)) take_plan(std::move(message), sample.received);
}

void BusReader::take_plan(link::PlanMessage message, UtcTime received) {
  auto plan = gate_.plan(message, received);
  if (!plan) {
    waiting_plan_.keep(std::move(message), plan.error(), gate_.planner_epoch());
    return;
  }
  plan_ = std::move(*plan);
  observer_.on_plan({.flow = plan_,
                     .version = message.version,
                     .excess_m = message.excess_m,
                     .received = received});
}

void BusReader::take_scene(const TappedSample& sample) {
  link::SceneMessage message;
  if (!decode(sample, message)) return;
  const auto scene = gate_.scene(message, sample.received);
  // Version 0 is the mission file's, which observers know from the beginning.
  if (scene && scene->version != 0) observer_.on_scene(*scene);
}

void BusReader::take_heartbeat(const TappedSample& sample) {
  link::HeartbeatMessage message;
  if (!decode(sample, message) || !gate_.heartbeat(message, sample.received)) return;
  if (auto plan = waiting_plan_.take(gate_.planner_epoch())) {
    take_plan(std::move(*plan), sample.received);
  }
  observer_.on_clock({.phase = message.phase,
                      .mission_time_s = message.mission_time_s,
                      .plan_time_s = message.plan_time_s,
                      .plan_rate = message.plan_rate,
                      .received = sample.received,
                      .stamp = UtcTime(Duration(message.stamp_utc_ns))});
}

void BusReader::take_command(const TappedSample& sample) {
  // Commands are not reported to observers: their effect is visible in heartbeats. They pass the
  // gate so that refused ones are counted.
  link::CommandMessage message;
  if (decode(sample, message)) (void)gate_.command(message, sample.received);
}

void BusReader::take_event(const TappedSample& sample) {
  link::EventMessage message;
  if (!decode(sample, message) || !gate_.event(message)) return;
  observer_.on_event({.received = sample.received,
                      .stamp = UtcTime(Duration(message.stamp_utc_ns)),
                      .source = link::source_name(message.source),
                      .severity = std::string(link::to_string(message.severity)),
                      .code = message.code,
                      .text = message.text});
}

}  // namespace swarm::monitor
