// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "swarm_link/messages.hpp"
#include "swarmflow/core/ids.hpp"
#include "swarmflow/core/plan_clock.hpp"
#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/phase.hpp"

namespace swarm::planner {

/// What a heartbeat reports, as of a step of the planner's loop.
struct PlannerState {
  MissionPhase phase = MissionPhase::kReady;
  std::int64_t t0_utc_ns = 0;  ///< start of the mission; 0: not yet
  PlanClock clock{};           ///< its stamp is not used: `at` is
  SteadyTime at{};             ///< of the step
};

/// Makes the planner's heartbeats from the state after its last step, which may be long ago if the
/// planner plans: τ advances meanwhile at the rate of that step, as it does for the receivers and
/// for the keeper of the clock, which adds the same time at its next step.
///
/// A planning method may take long, but a step that outlasts `longest_step` hangs: then there are
/// no more heartbeats, so that the robots hold and the launcher restarts the planner. Pure; the
/// times are passed in. Not thread-safe.
class HeartbeatSource {
 public:
  HeartbeatSource(PlannerEpoch epoch, Duration longest_step)
      : epoch_(epoch), longest_step_(longest_step) {}

  void on_step(const PlannerState& state) { state_ = state; }

  /// No more heartbeats until the next step: another planner leads.
  void pause() { state_.reset(); }
  /// The planner leads from its next step on, under another epoch.
  void begin_epoch(PlannerEpoch epoch) {
    epoch_ = epoch;
    state_.reset();
    beats_ = 0;
    published_ = {};
  }

  /// The next heartbeat; empty before the first step and while a step hangs.
  std::optional<link::HeartbeatMessage> next(SteadyTime now, UtcTime utc) {
    if (!state_ || now - state_->at > longest_step_) return std::nullopt;
    const PlanClock& clock = state_->clock;
    const double waited_s = std::max(0.0, to_seconds(now - state_->at));
    published_ = {.stamp = utc,
                  .plan_version = clock.plan_version,
                  .plan_time_s = clock.plan_time_s + clock.rate * waited_s,
                  .rate = clock.rate};
    const std::int64_t stamp_ns = utc.time_since_epoch().count();
    const bool has_begun = state_->t0_utc_ns != 0;
    const Duration since_start = utc - UtcTime(Duration(state_->t0_utc_ns));
    return link::HeartbeatMessage{.phase = state_->phase,
                                  .version = clock.plan_version,
                                  .epoch = epoch_.value(),
                                  .sequence_number = ++beats_,
                                  .stamp_utc_ns = stamp_ns,
                                  .mission_time_s = has_begun ? to_seconds(since_start) : 0.0,
                                  .plan_time_s = published_.plan_time_s,
                                  .plan_rate = clock.rate};
  }

  /// The clock in the last heartbeat: what the receivers have, and so the least the clock may show
  /// from now on.
  const PlanClock& published() const { return published_; }

 private:
  PlannerEpoch epoch_;
  Duration longest_step_;
  std::optional<PlannerState> state_;
  std::uint64_t beats_ = 0;
  PlanClock published_;
};

}  // namespace swarm::planner
