// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "swarm_monitor/audit/recorded_run.hpp"
#include "swarm_monitor/audit/tracking/sample_distance.hpp"

namespace swarm::monitor {

/// Where the robots that were not lost ended.
struct Ending {
  static constexpr double kNear_m = 0.7, kWide_m = 1.0;

  /// Of their last positions to the goal mixture: by assignment, not by the goals that robots name.
  std::optional<Distance> to_goal{};
  /// Of the last references that they logged to the goal mixture: a robot cannot make its own place
  /// be where it happened to end. Empty unless every one of them logged one.
  std::optional<Distance> references_to_goal{};
  /// Shares within kNear_m and kWide_m of their own last reference; a robot that logged none is
  /// not there. Empty if none logged one.
  std::optional<double> own_place_share{}, own_place_wide_share{};
};

/// Of more than `most_robots` robots every n-th enters the distances. Eight to twelve
/// assignments of at most 500.
Ending ending_of(const RecordedRun& run, std::size_t most_robots = 500);

}  // namespace swarm::monitor
