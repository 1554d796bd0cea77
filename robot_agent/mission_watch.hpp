// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/phase.hpp"

namespace swarm::agent {

/// What a process knows of the mission: its phase, changed by commands, and whether the planner
/// is alive.
///
///   ready ──start──▶ running ◀──resume/pause──▶ paused        any ──stop──▶ stopped (for good)
///
/// Commands have passed the Gate: each once, in the order of their ids, except that a stop may come
/// at any time and more than once.
class MissionWatch {
 public:
  /// `resume_delay`: time for which the planner must be received again after a silence before
  /// robots move. A process cut off from the planner was cut off from its neighbours, too: the
  /// delay lets it receive their states first.
  explicit MissionWatch(Duration planner_silence, Duration resume_delay = Duration::zero())
      : planner_silence_(planner_silence), resume_delay_(resume_delay) {}

  void on_command(CommandKind kind) { phase_ = phase_after(phase_, kind); }

  void on_heartbeat(SteadyTime now) {
    if (!received_ || now - received_at_ > planner_silence_) back_at_ = now;
    received_ = true;
    received_at_ = now;
  }

  MissionPhase phase() const { return phase_; }
  /// When the planner was received last; empty: never.
  std::optional<SteadyTime> planner_received_at() const {
    return received_ ? std::optional(received_at_) : std::nullopt;
  }
  /// Whether robots may move: the planner is received, and has been for resume_delay.
  bool planner_alive(SteadyTime now) const {
    return received_ && now - received_at_ <= planner_silence_ && now - back_at_ >= resume_delay_;
  }

 private:
  Duration planner_silence_;
  Duration resume_delay_;
  MissionPhase phase_ = MissionPhase::kReady;
  bool received_ = false;
  SteadyTime received_at_;
  SteadyTime back_at_;  // begin of reception without a silence
};

}  // namespace swarm::agent
