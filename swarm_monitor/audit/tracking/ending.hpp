// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "swarm_monitor/audit/recorded_run.hpp"
#include "swarm_monitor/audit/tracking/sample_distance.hpp"

namespace swarm::monitor {

/// Final positions of the robots that were not lost, against the goal and against their own slots.
struct Ending {
  static constexpr double kNear_m = 0.7, kWide_m = 1.0;

  /// W2 of the last positions to the goal mixture, by assignment, whichever goals robots name.
  std::optional<Distance> to_goal{};
  /// W2 of the last logged references to the goal mixture. It guards the shares below: a robot
  /// cannot count its final position as its slot by logging it as its reference. Empty unless every
  /// robot logged a reference.
  std::optional<Distance> references_to_goal{};
  /// Shares within kNear_m and kWide_m of their own last reference; a robot that logged none is
  /// not there. Empty if none logged one.
  std::optional<double> own_place_share{}, own_place_wide_share{};
};

/// Of more than `most_robots` robots every n-th enters the distances. Eight to twelve
/// assignments of at most 500.
Ending ending_of(const RecordedRun& run, std::size_t most_robots = 500);

}  // namespace swarm::monitor
