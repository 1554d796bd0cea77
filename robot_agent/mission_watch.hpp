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
  /// `settle`: so long a planner must be heard again after a silence. Whoever was cut off from it
  /// was from others, and hears them, too, before it moves.
  explicit MissionWatch(Duration planner_silence, Duration settle = Duration::zero())
      : planner_silence_(planner_silence), settle_(settle) {}

  void on_command(CommandKind kind) { phase_ = phase_after(phase_, kind); }

  void on_heartbeat(SteadyTime now) {
    if (!heard_ || now - heard_at_ > planner_silence_) back_at_ = now;
    heard_ = true;
    heard_at_ = now;
  }

  MissionPhase phase() const { return phase_; }
  bool planner_alive(SteadyTime now) const {
    return heard_ && now - heard_at_ <= planner_silence_ && now - back_at_ >= settle_;
  }

 private:
  Duration planner_silence_;
  Duration settle_;
  MissionPhase phase_ = MissionPhase::kReady;
  bool heard_ = false;
  SteadyTime heard_at_;
  SteadyTime back_at_;  // heard without a silence since
};

}  // namespace swarm::agent
