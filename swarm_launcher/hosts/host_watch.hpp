// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "swarm_core/base/time.hpp"

namespace swarm::launcher {

/// Whether another host can be heard, by the statuses of its robots: each says one a second.
class HostWatch {
 public:
  explicit HostWatch(std::uint32_t robots)
      : patience_(std::chrono::milliseconds(1000 + 1500 / std::max(1U, robots))) {}

  void on_status(SteadyTime now) { heard_at_ = now; }

  enum class Change { kCut, kBack };
  /// What has changed since the last call.
  std::optional<Change> step(SteadyTime now) {
    if (!heard_at_ || cut_ == (now - *heard_at_ > patience_)) return std::nullopt;
    cut_ = !cut_;
    return cut_ ? Change::kCut : Change::kBack;
  }

  bool cut() const { return cut_; }
  Duration silence(SteadyTime now) const { return heard_at_ ? now - *heard_at_ : Duration::zero(); }

 private:
  Duration patience_;
  std::optional<SteadyTime> heard_at_;
  bool cut_ = false;
};

}  // namespace swarm::launcher
