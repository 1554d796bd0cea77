// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#include "swarm_launcher/flight/swarm_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace swarm::launcher {

// Moves the robot to its new cell. A robot without ticks has no position yet.
void SwarmView::take(const link::RobotStatusMessage& status) {
  link::RobotStatusMessage& known = robots_.at(status.robot_id);
  if (known.ticks > 0) std::erase(cell_at(known.x_m, known.y_m), status.robot_id);
  if (status.ticks > 0) cell_at(status.x_m, status.y_m).push_back(status.robot_id);
  known = status;
}

// Cells are as wide as the radius, so the disc touches nine at most.
bool SwarmView::receives_neighbours(std::uint32_t robot) const {
  const link::RobotStatusMessage& self = robots_.at(robot);
  std::uint32_t near = 0;
  for (const link::Cell& touched : link::cells_touching(
           {self.x_m, self.y_m}, communication_radius_m_, communication_radius_m_)) {
    const auto cell = cells_.find(touched);
    if (cell == cells_.end()) continue;
    for (const std::uint32_t id : cell->second) {
      const link::RobotStatusMessage& other = robots_[id];
      if (id == robot) continue;
      if (std::hypot(other.x_m - self.x_m, other.y_m - self.y_m) <= communication_radius_m_) ++near;
    }
  }
  return self.neighbours_heard >= near;
}

// Rates are differences of the robots' counters. A restarted robot counts from zero again: then the
// sum may shrink, and the rate is shown as zero.
std::string SwarmView::describe(SteadyTime now) {
  Totals totals;
  double gap = std::numeric_limits<double>::infinity();
  for (const link::RobotStatusMessage& r : robots_) {
    if (r.ticks == 0) continue;
    totals.sent += r.states_sent;
    totals.received += r.states_received;
    totals.ticks += r.ticks;
    totals.late += r.late_ticks;
    gap = std::min(gap, r.nearest_gap_m);
  }
  const double elapsed = std::max(1e-3, to_seconds(now - at_));
  const auto rate = [&](std::uint64_t after, std::uint64_t before) {
    return static_cast<double>(after - std::min(after, before)) / elapsed;
  };
  const double late = totals.ticks == 0 ? 0.0
                                        : 100.0 * static_cast<double>(totals.late) /
                                              static_cast<double>(totals.ticks);
  std::string text =
      fmt::format("{}states {:.0f}/s sent, {:.0f}/s received  late {:.2f} %",
                  gap < 1e3 ? fmt::format("nearest gap {:.2f} m  ", gap) : "",
                  rate(totals.sent, before_.sent), rate(totals.received, before_.received), late);
  before_ = totals;
  at_ = now;
  return text;
}

}  // namespace swarm::launcher
