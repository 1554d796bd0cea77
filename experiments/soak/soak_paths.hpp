// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>

#include "swarm_core/metrics/histogram.hpp"
#include "swarm_link/messages.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// How long messages of the other paths took in a soak, as the launcher sees it. Ids of commands
/// and versions of scenes are the times of their publication.
struct PathLatencies {
  Histogram status{};   ///< a status, from its process to the launcher [µs]
  Histogram command{};  ///< from the launcher to the robots and back in a status
  Histogram plan{};     ///< from a scene by the planner and its plan to the robots' status
  Histogram beat{};     ///< between two heartbeats of the planner
  std::uint64_t commands = 0, scenes = 0;  ///< that some robot has obeyed or followed
  /// Largest time by which a status came before it was sent, by the clocks [µs]: their error.
  std::int64_t clock_error_us = 0;
};

/// Measures them. One thread at a time.
class PathMeter {
 public:
  void on_status(const link::StatusMessage& status, UtcTime now) {
    const std::int64_t age_us = to_us(now.time_since_epoch().count() - status.stamp_utc_ns);
    latencies_.clock_error_us = std::max(latencies_.clock_error_us, -age_us);
    latencies_.status.add(std::max<std::int64_t>(0, age_us));
    Seen& seen = seen_[status.process_id];
    count(status.command_id, seen.command, newest_.command, status.stamp_utc_ns, latencies_.command,
          latencies_.commands);
    count(status.plan_scene_version, seen.scene, newest_.scene, status.stamp_utc_ns,
          latencies_.plan, latencies_.scenes);
  }
  void on_heartbeat(SteadyTime now) {
    if (last_beat_ != SteadyTime{}) latencies_.beat.add(to_us((now - last_beat_).count()));
    last_beat_ = now;
  }
  const PathLatencies& latencies() const { return latencies_; }

 private:
  /// Newest numbers, of one process or of all.
  struct Seen {
    std::uint64_t command = 0, scene = 0;
  };
  static std::int64_t to_us(std::int64_t ns) { return ns / 1000; }

  /// The first number of a process is from before the measurement.
  static void count(std::uint64_t number, std::uint64_t& seen, std::uint64_t& newest,
                    std::int64_t stamp_ns, Histogram& latency, std::uint64_t& numbers) {
    if (number <= seen) return;
    const bool is_first = seen == 0;
    seen = number;
    if (is_first) {
      newest = std::max(newest, number);
      return;
    }
    latency.add(std::max<std::int64_t>(0, to_us(stamp_ns - static_cast<std::int64_t>(number))));
    if (number > newest) {
      newest = number;
      ++numbers;
    }
  }

  PathLatencies latencies_;
  std::map<std::uint32_t, Seen> seen_;  // by process
  Seen newest_;
  SteadyTime last_beat_;
};

}  // namespace swarm::launcher
