// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/hosts/host_watch.hpp"

#include <algorithm>
#include <chrono>

namespace swarm::launcher {
namespace {

// Before a host that was received once is gone for good, and before one that never was.
constexpr Duration kLeastGone = std::chrono::seconds(60);
constexpr Duration kLeastFirst = std::chrono::seconds(10);

}  // namespace

HostWatch::HostWatch(std::uint32_t messages, const HostTimes& times, SteadyTime joined)
    : timeout_(from_seconds((1.0 + 1.5 / std::max(1U, messages)) / times.status_hz)),
      first_(std::max({kLeastFirst, 5 * timeout_, from_seconds(times.quorum_timeout_s / 2.0)})),
      joined_at_(joined) {}

std::optional<HostWatch::Change> HostWatch::step(SteadyTime now) {
  if (!received_at_ || cut_ == (now - *received_at_ > timeout_)) return std::nullopt;
  cut_ = !cut_;
  return cut_ ? Change::kCut : Change::kBack;
}

bool HostWatch::lost(SteadyTime now) const {
  return received_at_ ? now - *received_at_ > std::max(kLeastGone, 10 * timeout_)
                      : now - joined_at_ > first_;
}

}  // namespace swarm::launcher
