// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "swarmflow/mission/option_table.hpp"

/// Keys of the mission's control section that more than one built-in method reads.
namespace swarm::agent {

/// Keys of methods that follow a path.
struct PathKeys {
  double look_ahead_s = 6.0;
  double approach_gain_hz = 0.8;
  double stuck_after_s = 4.0;
  double escape_s = 5.0;
};

inline OptionTable<PathKeys> path_keys() {
  return OptionTable<PathKeys>()
      .number("look_ahead_s", &PathKeys::look_ahead_s, between(0, 600),
              "how far ahead on its path a robot aims")
      .number("approach_gain_hz", &PathKeys::approach_gain_hz, positive(1000),
              "speed per metre to the aim point near the end")
      .number("stuck_after_s", &PathKeys::stuck_after_s, positive(3600),
              "after this long without progress a robot leaves its path for a while")
      .number("escape_s", &PathKeys::escape_s, between(0, 600),
              "longest time off the path; crops: time in one random direction");
}

/// Keys of methods with a repulsion from obstacles.
struct ObstacleKeys {
  double obstacle_gap_m = 0.5;
  double obstacle_push_mps = 1.0;
};

inline OptionTable<ObstacleKeys> obstacle_keys() {
  return OptionTable<ObstacleKeys>()
      .number("obstacle_gap_m", &ObstacleKeys::obstacle_gap_m, between(0, 100),
              "obstacles nearer than this push")
      .number("obstacle_push_mps", &ObstacleKeys::obstacle_push_mps, between(0, 100),
              "speed of that push at contact");
}

}  // namespace swarm::agent
