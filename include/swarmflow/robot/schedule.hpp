// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace swarm::agent {

/// The plan's time of a robot, and how fast it advances: τ and dτ/dt of PlanClock.
struct PlanTime {
  double plan_time_s = 0.0;
  double rate = 1.0;
};

/// When a robot is to be where on its own path: l*(τ) [m], piecewise linear through the plan times
/// of the Gaussians it passes and the arc lengths of its own points in them. Flat where the plan
/// waits, constant before the first and after the last entry.
class Schedule {
 public:
  struct Entry {
    double time_s = 0.0;  ///< plan time
    double at_m = 0.0;    ///< arc length on the robot's path
  };

  Schedule() = default;
  /// \pre some entries; neither times nor arc lengths descend
  explicit Schedule(std::vector<Entry> entries);

  /// l*(τ) [m].
  double at_m(double plan_time_s) const;

  /// Signed lag [s] of a robot that is at an arc length when it should be at l*(τ): τ minus the
  /// nearest time at which l* is there, so 0 anywhere in a wait; negative if it is ahead. What is
  /// missing before the first entry counts at the schedule's mean speed.
  double lag_s(double plan_time_s, double at_m) const;

  double end_s() const { return entries_.back().time_s; }

  /// Mean speed while it moves [m/s]; 1 if it never does.
  double mean_speed_mps() const { return mean_speed_mps_; }

 private:
  /// Index of the segment that holds τ: 0 … size − 2.
  std::size_t segment_at(double plan_time_s) const;

  std::vector<Entry> entries_;
  double mean_speed_mps_ = 1.0;
  mutable std::size_t near_ = 0;  // the segment asked for last: time passes slowly
};

}  // namespace swarm::agent
