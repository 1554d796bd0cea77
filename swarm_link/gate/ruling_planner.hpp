// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "swarmflow/core/time.hpp"

namespace swarm::link {

/// Which of several planners a receiver follows: the one whose heartbeats it receives. Another one,
/// whatever its epoch, is followed only once the ruling one has been silent for the takeover time.
/// So a forged or foreign heartbeat changes nothing while the planner beats, and a planner that was
/// followed by mistake is left when it falls silent. Of a recording, which may be played faster
/// than it was made, the newest planner leads at once. Pure; times are of the receiver's clock.
class RulingPlanner {
 public:
  /// Without a takeover time the planner with the latest epoch leads.
  explicit RulingPlanner(std::optional<Duration> takeover) : takeover_(takeover) {}

  /// Of the planner that is followed; 0 before the first plan or heartbeat.
  std::uint64_t epoch() const { return epoch_; }

  /// Whether plans of this planner pass: of the ruling one, and while that is silent or has never
  /// been received, of one that started later.
  bool admits_plan(std::uint64_t epoch, UtcTime now) const {
    return epoch == epoch_ || (epoch > epoch_ && (!takeover_ || !is_alive(now)));
  }
  /// A plan has passed. By itself it does not show that its planner is alive.
  void on_plan(std::uint64_t epoch) {
    if (epoch == epoch_) return;
    epoch_ = epoch;
    last_beat_at_.reset();
  }

  /// Whether heartbeats of this planner pass.
  bool admits_heartbeat(std::uint64_t epoch, UtcTime now) const {
    return epoch == epoch_ || (takeover_ ? !is_alive(now) : epoch > epoch_);
  }
  /// A heartbeat has passed: its sender rules.
  void on_heartbeat(std::uint64_t epoch, UtcTime now) {
    epoch_ = epoch;
    last_beat_at_ = now;
  }
  /// Whether the ruling planner is alive: it beats.
  bool is_alive(UtcTime now) const {
    return last_beat_at_ && (!takeover_ || now - *last_beat_at_ <= *takeover_);
  }

 private:
  std::optional<Duration> takeover_;
  std::uint64_t epoch_ = 0;
  std::optional<UtcTime> last_beat_at_{};  ///< last heartbeat of the ruling planner
};

}  // namespace swarm::link
