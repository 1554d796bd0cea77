// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/core/time.hpp"
#include "swarmflow/mission/phase.hpp"

namespace swarm::agent {

/// What a process knows of the mission: its phase, moved by commands, and whether the planner
/// lives.
///
///   ready ──start──▶ running ◀──resume/pause──▶ paused        any ──stop──▶ stopped (for good)
///
/// Commands have passed the Gate: each once, in the order of their ids, except that a stop may come
/// at any time and more than once.
class MissionWatch {
 public:
  /// `resume_delay`: so long a planner must be received again after a silence. Whoever was cut off from it
  /// was from others, and hears them, too, before it moves.
  explicit MissionWatch(Duration planner_silence, Duration resume_delay = Duration::zero())
      : planner_silence_(planner_silence), resume_delay_(resume_delay) {}

  void on_command(CommandKind kind) { phase_ = phase_after(phase_, kind); }

  void on_heartbeat(SteadyTime now) {
    if (!received_ || now - received_at_ > planner_silence_) back_at_ = now;
    received_ = true;
    received_at_ = now;
  }

  MissionPhase phase() const { return phase_; }
  bool planner_alive(SteadyTime now) const {
    return received_ && now - received_at_ <= planner_silence_ && now - back_at_ >= resume_delay_;
  }

 private:
  Duration planner_silence_;
  Duration resume_delay_;
  MissionPhase phase_ = MissionPhase::kReady;
  bool received_ = false;
  SteadyTime received_at_;
  SteadyTime back_at_;  // heard without a silence since
};

}  // namespace swarm::agent
