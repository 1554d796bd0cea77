// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace swarm::agent {

/// Plan time as a robot knows it at a tick, from the planner's heartbeats (see PlanClock).
struct PlanTime {
  double plan_time_s = 0.0;  ///< τ [s]
  double rate = 1.0;         ///< dτ/dt, in [0, 1]; 0 while the mission is paused
};

/// When a robot is to be where on its own path: the arc length l*(τ) [m], piecewise linear through
/// the plan times of the Gaussians it passes and the arc lengths of its own points in them. Flat
/// where the plan waits, constant before the first and after the last entry.
///
/// at_m() remembers the segment it used: one object must not be used by several threads at once.
class Schedule {
 public:
  /// A corner of l*.
  struct Entry {
    double time_s = 0.0;  ///< plan time [s]
    double at_m = 0.0;    ///< arc length on the robot's path [m]
  };

  /// A schedule without entries, only good for assignment.
  Schedule() = default;
  /// \pre at least one entry; neither times nor arc lengths decrease; asserted
  explicit Schedule(std::vector<Entry> entries);

  /// l*(τ), the arc length at which the robot is to be [m]. O(1) for calls whose τ changes slowly;
  /// does not allocate.
  double at_m(double plan_time_s) const;

  /// Signed lag of a robot that is at an arc length s [m] at plan time τ [s]:
  ///
  ///   lag = τ − t,   t the time with l*(t) = s that is nearest to τ
  ///
  /// so 0 throughout a wait, and negative for a robot that is ahead. A distance before the first
  /// entry counts at mean_speed_mps(); a robot at the end is never late. O(entries), does not
  /// allocate.
  double lag_s(double plan_time_s, double at_m) const;

  /// Plan time of the last entry, at which the robot is to arrive [s].
  /// \pre some entries; not checked
  double end_s() const { return entries_.back().time_s; }

  /// Mean of l*′ over the parts where it is not flat [m/s]; 1 if it is flat everywhere.
  double mean_speed_mps() const { return mean_speed_mps_; }

 private:
  // Index of the segment that holds τ: 0 … size − 2.
  std::size_t segment_at(double plan_time_s) const;

  std::vector<Entry> entries_;
  double mean_speed_mps_ = 1.0;
  mutable std::size_t near_ = 0;  // segment of the last call: plan time changes slowly
};

}  // namespace swarm::agent
