// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_link/gate/gate.hpp"

#include <algorithm>
#include <chrono>

#include "swarm_core/base/stamp.hpp"

namespace swarm::link {
namespace {

// Plans and heartbeats are numbered from 1 in each epoch, which is the UTC time [ns] at which the
// planner started. A planner publishes one of either every few milliseconds at most, so a larger
// number is forged; if accepted, it would outrank all later real ones.
constexpr std::uint64_t kNumbersPerSecond = 1'000;

bool is_reached(std::uint64_t number, std::uint64_t epoch, std::uint64_t latest_ns) {
  const std::uint64_t age_s = (latest_ns - epoch) / 1'000'000'000;
  return number / kNumbersPerSecond <= age_s + 1;
}

std::uint64_t to_ns(UtcTime time) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(time.time_since_epoch().count(), 0));
}

// Stamps are signed on the wire; a negative one is in the past.
bool is_after(std::int64_t stamp_utc_ns, std::uint64_t latest_ns) {
  return stamp_utc_ns > 0 && static_cast<std::uint64_t>(stamp_utc_ns) > latest_ns;
}

}  // namespace

Gate::Gate(const GateOptions& options)
    : options_(options),
      ruler_(options.stamps == Stamps::kLive ? std::optional(options.limits.planner_takeover)
                                             : std::nullopt),
      status_owners_(options.limits.status_takeover) {}

std::uint64_t Gate::latest_ns(UtcTime now) const {
  return to_ns(now + options_.limits.clock_skew_refuse);
}

// Content first, order last: only a valid message may become the newest of its topic.
Checked<FlowPlan> Gate::plan(const PlanMessage& message, UtcTime now) {
  auto checked = check_plan(message, options_.limits);
  if (checked) {
    if (const auto ordered = order(message, now); !ordered) checked = refuse(ordered.error());
  }
  return counted(std::move(checked));
}

Checked<void> Gate::order(const PlanMessage& message, UtcTime now) {
  const std::uint64_t latest = latest_ns(now);
  if (message.epoch > latest || message.scene_version > latest ||
      !is_reached(message.version, message.epoch, latest)) {
    return refuse(RefusalReason::kForged);
  }
  if (!ruler_.admits_plan(message.epoch, now)) return refuse(RefusalReason::kStale);
  PlannerOrder order = order_of(message.epoch);
  const auto accepted = order.version.accept(message.version);
  if (accepted) {
    planner_ = order;
    ruler_.on_plan(message.epoch);
  }
  return accepted;
}

/// Versions and numbers of another planner begin anew.
Gate::PlannerOrder Gate::order_of(std::uint64_t epoch) const {
  return planner_.epoch == epoch ? planner_ : PlannerOrder{.epoch = epoch};
}

Checked<Scene> Gate::scene(const SceneMessage& message, UtcTime now) {
  auto checked = check_scene(message, options_.limits);
  if (checked) {
    if (const auto ordered = order(message, now); !ordered) checked = refuse(ordered.error());
  }
  return counted(std::move(checked));
}

Checked<void> Gate::order(const SceneMessage& message, UtcTime now) {
  if (message.version > latest_ns(now)) return refuse(RefusalReason::kForged);
  return scene_.accept(message.version);
}

Checked<void> Gate::heartbeat(const HeartbeatMessage& message, UtcTime now) {
  auto checked = check_heartbeat(message);
  if (checked) checked = order(message, now);
  return counted(checked);
}

Checked<void> Gate::heartbeat_of(const HeartbeatMessage& message, const Sent& sent) {
  const auto checked = heartbeat(message, sent.received);
  if (!checked) return checked;
  // Restarts are few: more senders than this are forged, and the planner's own comes back with its
  // next heartbeat.
  constexpr std::size_t kMostSenders = 64;
  if (planner_senders_.size() >= kMostSenders) planner_senders_.clear();
  planner_senders_.insert(sent.sender);
  return checked;
}

Checked<void> Gate::any_heartbeat(const HeartbeatMessage& message, UtcTime now) {
  auto checked = check_heartbeat(message);
  if (checked) checked = reach(message, now);
  return counted(checked);
}

/// Whether nothing in the message is from the future.
Checked<void> Gate::reach(const HeartbeatMessage& message, UtcTime now) const {
  const std::uint64_t latest = latest_ns(now);
  if (message.epoch > latest || is_after(message.stamp_utc_ns, latest) ||
      !is_reached(message.sequence_number, message.epoch, latest)) {
    return refuse(RefusalReason::kForged);
  }
  if (!is_stamp(message.stamp_utc_ns)) return refuse(RefusalReason::kOutOfRange);
  return {};
}

Checked<void> Gate::order(const HeartbeatMessage& message, UtcTime now) {
  if (const auto reached = reach(message, now); !reached) return reached;
  if (!ruler_.admits_heartbeat(message.epoch, now)) {
    ++foreign_heartbeats_;
    return refuse(RefusalReason::kStale);
  }
  PlannerOrder order = order_of(message.epoch);
  // After a silence any number passes: an invented one must not keep the real ones out for ever.
  if (!ruler_.is_alive(now)) order.beat = NewestKey<std::uint64_t>{0};
  const auto accepted = order.beat.accept(message.sequence_number);
  if (accepted) {
    planner_ = order;
    ruler_.on_heartbeat(message.epoch, now);
  }
  return accepted;
}

Checked<void> Gate::command(const CommandMessage& message, UtcTime now) {
  auto checked = check_command(message);
  if (checked) checked = order(message, now);
  return counted(checked);
}

// A stop passes whatever its stamp and id are: a clock that is off must not keep robots moving.
Checked<void> Gate::order(const CommandMessage& message, UtcTime now) {
  if (message.kind == CommandKind::kStop) return {};
  const std::uint64_t latest = latest_ns(now);
  if (message.command_id > latest || is_after(message.stamp_utc_ns, latest)) {
    return refuse(RefusalReason::kForged);
  }
  if (!is_stamp(message.stamp_utc_ns)) return refuse(RefusalReason::kOutOfRange);
  return command_.accept(message.command_id);
}

Checked<void> Gate::status(const StatusMessage& message, UtcTime now) {
  auto checked = check_status(message, options_.limits);
  if (checked) checked = order(message, now);
  return counted(checked);
}

// Only a valid status may own its robots.
Checked<void> Gate::status_of(const StatusMessage& message, const Sent& sent) {
  auto checked = check_status(message, options_.limits);
  if (checked) checked = order(message, sent.received);
  if (checked) checked = status_owners_.accept(message, sent);
  return counted(checked);
}

Checked<void> Gate::order(const StatusMessage& message, UtcTime now) const {
  const std::uint64_t latest = latest_ns(now);
  if (message.plan_epoch > latest || message.plan_scene_version > latest) {
    return refuse(RefusalReason::kForged);
  }
  if (is_after(message.stamp_utc_ns, latest)) return refuse(RefusalReason::kClockSkew);
  if (!is_stamp(message.stamp_utc_ns)) return refuse(RefusalReason::kOutOfRange);
  // The states of a robot whose clock is as far behind are refused as well: it is not well.
  const bool is_old =
      now - UtcTime(Duration(message.stamp_utc_ns)) > options_.limits.clock_skew_refuse;
  if (is_old && options_.stamps == Stamps::kLive) return refuse(RefusalReason::kClockSkew);
  return {};
}

Checked<void> Gate::event(const EventMessage& message) {
  auto checked = check_event(message, options_.limits);
  if (checked && options_.own_source == message.source) checked = refuse(RefusalReason::kForged);
  return counted(checked);
}

Checked<void> Gate::event_of(const EventMessage& message, const Sent& sent, bool is_evidence) {
  auto checked = check_event(message, options_.limits);
  const bool is_own = options_.own_source == message.source;
  if (checked && (is_own || !is_of_its_source(message, sent, is_evidence))) {
    checked = refuse(RefusalReason::kForged);
  }
  return counted(checked);
}

// A planner that stands by reports events, but publishes no heartbeats.
bool Gate::is_of_its_source(const EventMessage& message, const Sent& sent, bool is_evidence) const {
  if (sent.sender == 0) return true;
  if (message.source == kPlannerSource) {
    return !is_evidence || planner_senders_.contains(sent.sender);
  }
  const RobotId robot(message.source);
  return is_evidence ? status_owners_.is_of(robot, sent.sender)
                     : status_owners_.may_be_of(robot, sent.sender, sent.received);
}

// The vector is sized at the first call: only processes that forward states need it.
Checked<void> Gate::newer_state(const RobotStateMessage& state, UtcTime now) {
  auto checked = check_state(state, options_.limits, clock_for(state, now));
  // A stamp ahead outranks the robot's own states until its clock has reached it.
  constexpr Duration kMostAhead = std::chrono::seconds(1);
  if (checked && UtcTime(Duration(state.stamp_utc_ns)) > now + kMostAhead) {
    checked = refuse(RefusalReason::kClockSkew);
  }
  if (checked) {
    newest_state_.resize(options_.limits.robots);
    checked = newest_state_[state.robot_id].accept(state.stamp_utc_ns);
  }
  return counted(checked);
}

// Readers report totals; the counter takes the difference to the previous call.
void Gate::set_undecodable(std::uint64_t so_far) {
  refused_.count(RefusalReason::kUndecodable, static_cast<std::uint32_t>(so_far - undecodable_));
  undecodable_ = so_far;
}

void Gate::set_refused_beats(std::uint64_t so_far) {
  refused_.count(RefusalReason::kStale, static_cast<std::uint32_t>(so_far - refused_beats_));
  refused_beats_ = so_far;
}

}  // namespace swarm::link
