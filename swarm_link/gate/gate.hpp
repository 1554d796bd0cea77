// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "swarm_link/gate/content_checks.hpp"
#include "swarm_link/gate/echo_guard.hpp"
#include "swarm_link/gate/newest_key.hpp"

namespace swarm::link {

/// What stamps are measured against.
enum class Stamps : std::uint8_t {
  kLive,      ///< our clock: an old state is refused
  kRecorded,  ///< a replay sends what another day wrote: only stamps from the future are refused
};

struct GateOptions {
  WireLimits limits;
  Stamps stamps = Stamps::kLive;
  /// Events under this source are ours alone: one that is received is forged.
  std::optional<std::uint32_t> own_source{};
};

/// The one place where received messages are checked; agent, planner, launcher, monitor and gateway
/// have one each. A message either passes, and becomes the newest of its topic, or is counted by
/// reason and changes nothing.
///
/// Each function applies, in this order: the message by itself (content_checks.hpp); its future: no
/// epoch, scene version, command id or stamp may lie further ahead of `now` than clock_skew_refuse,
/// for these are UTC stamps of their makers, and an invented one would outrank everything real; its
/// order: newer than the newest that passed. A planner that takes over has a higher epoch, so its
/// version 1 passes and what its predecessor still sends does not.
///
/// Pure: no clock, no bus. Costs what reading the message costs; state() and batch() allocate
/// nothing. Not thread-safe.
class Gate {
 public:
  explicit Gate(const GateOptions& options);

  /// Ordered by (epoch, version).
  Checked<FlowPlan> plan(const PlanMessage& message, UtcTime now);
  /// Ordered by version; the first one passes with any.
  Checked<Scene> scene(const SceneMessage& message, UtcTime now);
  /// Ordered by (epoch, number).
  Checked<void> heartbeat(const HeartbeatMessage& message, UtcTime now);
  /// Ordered by id, except that a stop passes however old it is, and again and again.
  Checked<void> command(const CommandMessage& message, UtcTime now);
  /// In no order: nothing numbers statuses, and DDS keeps each writer's order.
  Checked<void> status(const StatusMessage& message, UtcTime now);
  /// By any clock: a process must be able to report that its own is wrong.
  Checked<void> event(const EventMessage& message);

  Checked<void> batch(const CellStatesMessage& message) { return counted(check_batch(message)); }
  /// `own` belongs to the robot of this process that the state claims to be of; null: of none.
  /// States are not ordered here: what a late one is worth, each robot's neighbour table decides.
  Checked<void> state(const RobotStateMessage& state, UtcTime now, const EchoGuard* own = nullptr) {
    Checked<void> checked = check_state(state, options_.limits, clock_for(state, now));
    if (checked && own != nullptr && !own->is_echo(state)) {
      checked = refuse(RefusalReason::kForged);
    }
    return counted(checked);
  }
  /// Each state once, and each robot's in the order of their stamps: for what passes states on.
  Checked<void> newer_state(const RobotStateMessage& state, UtcTime now);

  /// Samples that did not decode, of all readers together, since the start.
  void set_undecodable(std::uint64_t so_far);

  const RefusalCounters& refused() const { return refused_; }

 private:
  using Version = std::pair<std::uint64_t, std::uint64_t>;  // epoch, number in it

  template <class T>
  Checked<T> counted(Checked<T> checked) {
    if (!checked) refused_.count(checked.error());
    return checked;
  }
  UtcTime clock_for(const RobotStateMessage& state, UtcTime now) const {
    if (options_.stamps == Stamps::kLive) return now;
    return std::min(now, UtcTime(Duration(state.stamp_utc_ns)));
  }
  std::uint64_t latest_ns(UtcTime now) const;
  Checked<void> order(const PlanMessage& message, UtcTime now);
  Checked<void> order(const SceneMessage& message, UtcTime now);
  Checked<void> order(const HeartbeatMessage& message, UtcTime now);
  Checked<void> order(const CommandMessage& message, UtcTime now);
  Checked<void> order(const StatusMessage& message, UtcTime now) const;

  GateOptions options_;
  RefusalCounters refused_;
  std::uint64_t undecodable_ = 0;
  NewestKey<Version> plan_{{0, 0}};
  NewestKey<std::uint64_t> scene_;
  NewestKey<Version> heartbeat_{{0, 0}};
  NewestKey<std::uint64_t> command_{0};
  std::vector<NewestKey<std::int64_t>> newest_state_;  // by robot, once newer_state() is used
};

}  // namespace swarm::link
