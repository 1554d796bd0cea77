// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>

#include "swarm_core/mission/supervision_times.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// How long a process may publish nothing.
struct SilenceLimits {
  Duration reported = std::chrono::seconds(3);  ///< then an event names it
  Duration ended = std::chrono::seconds(10);    ///< then it is killed, as it will not end by itself

  /// Of a process that publishes `rate_hz` times a second: those above, and at least three and ten
  /// periods.
  static SilenceLimits of(double rate_hz) {
    return {reported_silence(rate_hz),
            std::max(SilenceLimits{}.ended, from_seconds(10.0 / rate_hz))};
  }
};

/// Since when nothing has been received from a process. A process that was received once and then
/// is not, hangs or is cut off. One that has not been received since its start may still be
/// starting: only unreceived_for() counts its time. Pure; the times are passed in.
class SilenceWatch {
 public:
  enum class Change { kNone, kSilent, kBack };

  void on_start(SteadyTime now) { *this = SilenceWatch(now); }
  /// Received since the last step().
  void on_received() { is_fresh_ = true; }
  /// The receiver itself did not run for a while: the silence counts from now on.
  void restart(SteadyTime now) { since_ = now; }

  /// The process became silent, or is received again, since the last call.
  Change step(SteadyTime now, const SilenceLimits& limits) {
    if (is_fresh_) {
      was_received_ = true;
      since_ = now;
    }
    is_fresh_ = false;
    const bool is_silent = was_received_ && now - since_ > limits.reported;
    if (is_silent == is_silent_) return Change::kNone;
    is_silent_ = is_silent;
    return is_silent ? Change::kSilent : Change::kBack;
  }

  /// As of the last step().
  bool is_silent() const { return is_silent_; }
  /// Received and then silent for as long as the limit.
  bool is_overdue(SteadyTime now, const SilenceLimits& limits) const {
    return was_received_ && now - since_ > limits.ended;
  }
  /// Time since it was received last; of one that was never received since its start.
  Duration silent_for(SteadyTime now) const { return now - since_; }
  /// Time since the start of a process that was never received since then; otherwise zero.
  Duration unreceived_for(SteadyTime now) const {
    return was_received_ ? Duration::zero() : now - since_;
  }

  SilenceWatch() = default;

 private:
  explicit SilenceWatch(SteadyTime now) : since_(now) {}

  SteadyTime since_;
  bool is_fresh_ = false;
  bool was_received_ = false;
  bool is_silent_ = false;
};

}  // namespace swarm::launcher
