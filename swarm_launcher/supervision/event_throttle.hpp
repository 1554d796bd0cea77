// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// Bounds how many events of each sender are logged, so that a sender which floods the launcher, by
/// a fault or on purpose, fills neither the disk nor the log: a token bucket per sender. Senders
/// are distinguished by the DDS participant that published the event, and not by the source that
/// the event names, so that a flood in a robot's name does not silence the robot. Pure; the times
/// are passed in. Not thread-safe.
class EventThrottle {
 public:
  static constexpr double kBurst = 200.0;    ///< events at once
  static constexpr double kPerSecond = 5.0;  ///< events in the long run
  static constexpr Duration kReportPeriod = std::chrono::seconds(10);
  /// Most senders with a bucket of their own; all others share one.
  static constexpr std::size_t kMostSenders = 4096;

  /// Whether an event of this sender may be logged; otherwise it is counted.
  bool admit(std::uint64_t sender, SteadyTime now);

  /// What was dropped since the last report, as a sentence; at most once in kReportPeriod, and only
  /// if there is something to report.
  std::optional<std::string> report(SteadyTime now);

 private:
  struct Bucket {
    double tokens = kBurst;
    SteadyTime filled_at{};
    std::uint64_t dropped = 0;  ///< since the last report
  };
  Bucket& bucket_of(std::uint64_t sender, SteadyTime now);

  std::map<std::uint64_t, Bucket> buckets_;
  Bucket others_;
  std::optional<SteadyTime> reported_at_;
};

}  // namespace swarm::launcher
