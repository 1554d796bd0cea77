// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "swarm_link/gate/content_checks.hpp"
#include "swarm_link/gate/echo_guard.hpp"
#include "swarm_link/gate/newest_key.hpp"
#include "swarm_link/gate/ruling_planner.hpp"
#include "swarm_link/gate/status_owners.hpp"

namespace swarm::link {

/// Reference that stamps are compared with.
enum class Stamps : std::uint8_t {
  kLive,      ///< this machine's clock: an old state is refused
  kRecorded,  ///< replay of old data: only stamps from the future are refused
};

/// Settings of a Gate.
struct GateOptions {
  WireLimits limits;
  Stamps stamps = Stamps::kLive;
  /// Only this process sends events under this source: a received one is forged.
  std::optional<std::uint32_t> own_source{};
};

/// Checks received messages; agent, planner, launcher, monitor and gateway have one each. A message
/// either passes and becomes the newest of its topic, or is counted by reason and changes nothing.
///
/// Each function checks, in this order: the message by itself (content_checks.hpp); that it is not
/// from the future: no epoch, scene version, command id or stamp may lie further ahead of `now`
/// than clock_skew_refuse, because these are UTC stamps of their senders and an invented one would
/// outrank everything real; its order: newer than the newest that passed. Of several planners only
/// the ruling one passes (ruling_planner.hpp); its versions and numbers count anew.
///
/// Pure: no clock, no bus. Linear in the size of the message; state() and batch() do not allocate.
/// Not thread-safe.
class Gate {
 public:
  explicit Gate(const GateOptions& options);

  /// Ordered by version; of the ruling planner.
  Checked<FlowPlan> plan(const PlanMessage& message, UtcTime now);
  /// Ordered by version; the first one passes with any.
  Checked<Scene> scene(const SceneMessage& message, UtcTime now);
  /// Ordered by number; of the ruling planner.
  Checked<void> heartbeat(const HeartbeatMessage& message, UtcTime now);
  /// The same; remembers the sender as a planner.
  Checked<void> heartbeat_of(const HeartbeatMessage& message, const Sent& sent);
  /// Of any planner, in any order: for planners, which watch each other.
  Checked<void> any_heartbeat(const HeartbeatMessage& message, UtcTime now);
  /// Ordered by id, except that a stop passes whatever its stamp and id are, and again and again.
  Checked<void> command(const CommandMessage& message, UtcTime now);
  /// Not ordered: statuses have no number, and DDS keeps each writer's order.
  Checked<void> status(const StatusMessage& message, UtcTime now);
  /// The same, and of each robot only its own sender's (RawSample::sender).
  Checked<void> status_of(const StatusMessage& message, const Sent& sent);
  /// The process of a robot has ended: the next one may have another sender.
  void release_status(RobotId robot, UtcTime now) { status_owners_.release(robot, now); }
  /// With any stamp: a process must be able to report that its own clock is wrong.
  Checked<void> event(const EventMessage& message);
  /// The same, and not of a sender whose statuses of that robot are refused. `is_evidence`: it
  /// decides on the verdict of the run, so that it must come from the sender of the robot's
  /// statuses or of the planner's heartbeats.
  Checked<void> event_of(const EventMessage& message, const Sent& sent, bool is_evidence);

  /// The batch without its states, which the caller passes to state() one by one.
  Checked<void> batch(const CellStatesMessage& message) { return counted(check_batch(message)); }
  /// `own` belongs to the robot of this process whose id the state carries; null: the id is of
  /// another process. States are not ordered here: each robot's neighbour table decides whether a
  /// late one is useful.
  Checked<void> state(const RobotStateMessage& state, UtcTime now, const EchoGuard* own = nullptr) {
    Checked<void> checked = check_state(state, options_.limits, clock_for(state, now));
    if (checked && own != nullptr && !own->is_echo(state)) {
      checked = refuse(RefusalReason::kForged);
    }
    return counted(checked);
  }
  /// Passes each state once, and those of a robot in the order of their stamps. For processes that
  /// forward states.
  Checked<void> newer_state(const RobotStateMessage& state, UtcTime now);

  /// Sets the number of samples that could not be decoded, of all readers together, since the
  /// start.
  void set_undecodable(std::uint64_t so_far);

  /// Sets the number of the launcher's beats that were refused, since the start.
  void set_refused_beats(std::uint64_t so_far);

  const RefusalCounters& refused() const { return refused_; }

  /// Epoch of the planner whose messages pass; 0 before the first.
  std::uint64_t planner_epoch() const { return ruler_.epoch(); }
  /// Heartbeats of planners that do not rule, since the start.
  std::uint64_t foreign_heartbeats() const { return foreign_heartbeats_; }

 private:
  /// The newest plan and heartbeat of one planner.
  struct PlannerOrder {
    std::uint64_t epoch = 0;
    NewestKey<std::uint64_t> version{0};
    NewestKey<std::uint64_t> beat{0};
  };

  /// Counts a refusal and returns the result unchanged.
  template <class T>
  Checked<T> counted(Checked<T> checked) {
    if (!checked) refused_.count(checked.error());
    return checked;
  }
  /// The clock that a state is compared with. For recorded data it is the state's own stamp unless
  /// that lies in the future, so that age is no reason to refuse.
  UtcTime clock_for(const RobotStateMessage& state, UtcTime now) const {
    if (options_.stamps == Stamps::kLive) return now;
    return std::min(now, UtcTime(Duration(state.stamp_utc_ns)));
  }
  /// Latest stamp [ns] that a sender's clock can have reached.
  std::uint64_t latest_ns(UtcTime now) const;
  /// Checks future and order, and makes a message that passes the newest of its topic.
  Checked<void> order(const PlanMessage& message, UtcTime now);
  Checked<void> order(const SceneMessage& message, UtcTime now);
  Checked<void> order(const HeartbeatMessage& message, UtcTime now);
  Checked<void> reach(const HeartbeatMessage& message, UtcTime now) const;
  Checked<void> order(const CommandMessage& message, UtcTime now);
  Checked<void> order(const StatusMessage& message, UtcTime now) const;
  PlannerOrder order_of(std::uint64_t epoch) const;
  bool is_of_its_source(const EventMessage& message, const Sent& sent, bool is_evidence) const;

  GateOptions options_;
  RefusalCounters refused_;          ///< since the start
  std::uint64_t undecodable_ = 0;    ///< already counted
  std::uint64_t refused_beats_ = 0;  ///< already counted
  RulingPlanner ruler_;
  PlannerOrder planner_;  ///< of the ruling one
  std::uint64_t foreign_heartbeats_ = 0;
  NewestKey<std::uint64_t> scene_;  ///< the newest of each topic
  NewestKey<std::uint64_t> command_{0};
  StatusOwners status_owners_;
  std::set<std::uint64_t> planner_senders_;            ///< whose heartbeats passed, some of them
  std::vector<NewestKey<std::int64_t>> newest_state_;  // by robot, once newer_state() is used
};

}  // namespace swarm::link
