// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// Whether another host can be heard, by the statuses of its robots.
class HostWatch {
 public:
  /// So many messages come in every period of so many hertz; one in two may be late by a period.
  HostWatch(std::uint32_t messages, double status_hz)
      : patience_(from_seconds((1.0 + 1.5 / std::max(1U, messages)) / status_hz)) {}

  void on_status(SteadyTime now) { heard_at_ = now; }

  enum class Change { kCut, kBack };
  /// What has changed since the last call.
  std::optional<Change> step(SteadyTime now) {
    if (!heard_at_ || cut_ == (now - *heard_at_ > patience_)) return std::nullopt;
    cut_ = !cut_;
    return cut_ ? Change::kCut : Change::kBack;
  }

  bool cut() const { return cut_; }
  /// It has been silent for so long that it will not be back.
  bool lost(SteadyTime now) const {
    constexpr Duration kLeast = std::chrono::seconds(30);
    return heard_at_ && now - *heard_at_ > std::max(kLeast, 10 * patience_);
  }

 private:
  Duration patience_;
  std::optional<SteadyTime> heard_at_;
  bool cut_ = false;
};

}  // namespace swarm::launcher
