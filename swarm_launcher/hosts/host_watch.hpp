// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>

#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// Whether another host is reachable, by the statuses of its robots. Pure.
class HostWatch {
 public:
  /// The host joined at `joined`. `messages`: statuses of the host per period of 1/`status_hz`. The
  /// timeout tolerates that one of two messages is late by a period.
  HostWatch(std::uint32_t messages, double status_hz, SteadyTime joined)
      : timeout_(from_seconds((1.0 + 1.5 / std::max(1U, messages)) / status_hz)),
        joined_at_(joined) {}

  void on_status(SteadyTime now) { received_at_ = now; }

  /// The host became unreachable or reachable.
  enum class Change { kCut, kBack };
  /// What has changed since the last call.
  std::optional<Change> step(SteadyTime now) {
    if (!received_at_ || cut_ == (now - *received_at_ > timeout_)) return std::nullopt;
    cut_ = !cut_;
    return cut_ ? Change::kCut : Change::kBack;
  }

  bool cut() const { return cut_; }
  /// No status for ten timeouts, and at least 30 s: the host is treated as gone for good. One that
  /// never sent any is not waited for as long: 10 s or five timeouts after it joined others may
  /// have its robots.
  bool lost(SteadyTime now) const {
    constexpr Duration kLeast = std::chrono::seconds(30);
    constexpr Duration kFirst = std::chrono::seconds(10);
    return received_at_ ? now - *received_at_ > std::max(kLeast, 10 * timeout_)
                        : now - joined_at_ > std::max(kFirst, 5 * timeout_);
  }
  bool was_received() const { return received_at_.has_value(); }

 private:
  Duration timeout_;
  SteadyTime joined_at_;
  std::optional<SteadyTime> received_at_;  ///< empty: no status yet
  bool cut_ = false;
};

}  // namespace swarm::launcher
