// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// The times of a mission by which other hosts are judged.
struct HostTimes {
  double status_hz = 1.0;          ///< rate of each robot's status
  double quorum_timeout_s = 30.0;  ///< until then all robots are waited for
};

/// Whether another host is reachable, by the statuses of its robots. Pure.
class HostWatch {
 public:
  /// The host joined at `joined`. `messages`: statuses of the host per period of 1/`status_hz`. The
  /// timeout tolerates that one of two messages is late by a period.
  HostWatch(std::uint32_t messages, const HostTimes& times, SteadyTime joined);

  void on_status(SteadyTime now) { received_at_ = now; }
  /// The receiver itself did not run for a while: the silence counts from now on.
  void restart(SteadyTime now) {
    if (received_at_) received_at_ = now;
  }

  /// The host became unreachable or reachable.
  enum class Change { kCut, kBack };
  /// What has changed since the last call.
  std::optional<Change> step(SteadyTime now);

  bool cut() const { return cut_; }
  /// No status for ten timeouts, and at least 60 s: the host is treated as gone for good. One that
  /// never sent any is not waited for as long: half of the quorum's time after it joined others may
  /// have its robots, but not before 10 s and five timeouts.
  bool lost(SteadyTime now) const;
  bool was_received() const { return received_at_.has_value(); }

 private:
  Duration timeout_;
  Duration first_;  ///< within which a host reports for the first time
  SteadyTime joined_at_;
  std::optional<SteadyTime> received_at_;  ///< empty: no status yet
  bool cut_ = false;
};

}  // namespace swarm::launcher
