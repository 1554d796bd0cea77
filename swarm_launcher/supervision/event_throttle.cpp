// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/supervision/event_throttle.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace swarm::launcher {

// A sender that invents new identities shares a bucket once there are too many of them.
EventThrottle::Bucket& EventThrottle::bucket_of(std::uint64_t sender, SteadyTime now) {
  if (const auto known = buckets_.find(sender); known != buckets_.end()) return known->second;
  if (buckets_.size() >= kMostSenders) return others_;
  return buckets_.emplace(sender, Bucket{.filled_at = now}).first->second;
}

bool EventThrottle::admit(std::uint64_t sender, SteadyTime now) {
  Bucket& bucket = bucket_of(sender, now);
  const double passed_s = std::max(0.0, to_seconds(now - bucket.filled_at));
  bucket.tokens = std::min(kBurst, bucket.tokens + kPerSecond * passed_s);
  bucket.filled_at = now;
  if (bucket.tokens < 1.0) {
    ++bucket.dropped;
    return false;
  }
  bucket.tokens -= 1.0;
  return true;
}

std::optional<std::string> EventThrottle::report(SteadyTime now) {
  if (reported_at_ && now - *reported_at_ < kReportPeriod) return std::nullopt;
  std::uint64_t dropped = std::exchange(others_.dropped, 0);
  std::uint64_t senders = dropped > 0 ? 1 : 0;
  for (auto& [sender, bucket] : buckets_) {
    senders += bucket.dropped > 0 ? 1 : 0;
    dropped += std::exchange(bucket.dropped, 0);
  }
  if (dropped == 0) return std::nullopt;
  reported_at_ = now;
  return fmt::format("{} events of {} sender{} were not logged: more than {:.0f} a second", dropped,
                     senders, senders == 1 ? "" : "s", kPerSecond);
}

}  // namespace swarm::launcher
