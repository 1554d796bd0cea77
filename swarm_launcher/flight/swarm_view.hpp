// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "swarm_link/channels/cell.hpp"
#include "swarm_link/messages.hpp"
#include "swarmflow/core/time.hpp"

namespace swarm::launcher {

/// Summary of the robots' statuses, for the live line and the start of the mission. Not part of an
/// audit.
class SwarmView {
 public:
  SwarmView() = default;
  SwarmView(std::uint32_t robots, double communication_radius_m)
      : robots_(robots), communication_radius_m_(communication_radius_m) {}

  /// Replaces the status of a robot.
  void take(const link::RobotStatusMessage& status);

  /// Whether a robot receives at least as many neighbours as are within its communication radius by
  /// all statuses. O(robots in nine cells).
  bool receives_neighbours(std::uint32_t robot) const;

  /// "nearest gap 0.31 m  states 320/s sent, 2210/s received  late 0.00 %"; rates since the
  /// previous call.
  std::string describe(SteadyTime now);

 private:
  /// Sums over all robots since their start.
  struct Totals {
    std::uint64_t sent = 0, received = 0, ticks = 0, late = 0;
  };
  std::vector<std::uint32_t>& cell_at(double x_m, double y_m) {
    return cells_[link::cell_of({x_m, y_m}, communication_radius_m_)];
  }

  std::vector<link::RobotStatusMessage> robots_;
  double communication_radius_m_ = 0.0;
  std::map<link::Cell, std::vector<std::uint32_t>>
      cells_;  // robots, in cells as wide as the radius
  Totals before_;
  SteadyTime at_;
};

}  // namespace swarm::launcher
