// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "swarmflow/core/time.hpp"
#include "swarmflow/robot/schedule.hpp"

namespace swarm::agent {

/// The plan's clock as a process has it from the planner's heartbeats.
///
/// Between two heartbeats τ goes on at the rate received last, for `silence` at most; then it
/// stops, as the planner may have died. Per plan it never goes back, also when a restarted
/// planner publishes the same flow again and its clock has not caught up yet.
///
/// A heartbeat's age is taken from its stamp, on the planner's clock, and from the steady clock
/// here: the difference of the clocks is estimated as the least (receipt − stamp) of the last
/// kWindow_s to twice that. So a process whose wall clock is off, or is set, has the same τ; the
/// error is the delay of the quickest heartbeat of the window.
class PlanTimeWatch {
 public:
  static constexpr double kWindow_s = 15.0;
  /// A heartbeat older than this by the estimate means that the planner's clock was set back: its
  /// age counts as 0.
  static constexpr double kOldest_s = 1.0;

  explicit PlanTimeWatch(Duration silence) : silence_(silence) {}

  /// The fields of a heartbeat that set the plan's clock.
  struct Beat {
    std::uint32_t version = 0;
    double plan_time_s = 0.0;
    double rate = 0.0;
    std::int64_t stamp_utc_ns = 0;
  };
  void on_heartbeat(const Beat& beat, SteadyTime now);

  /// From now on the process follows this version; `same_flow`: it is the old plan under a new
  /// version.
  void on_plan(std::uint32_t version, bool same_flow);

  /// τ of the plan followed; empty until a heartbeat of that plan is received.
  std::optional<PlanTime> at(SteadyTime now);

 private:
  /// A heartbeat, its plan time extrapolated to its receipt.
  struct Received {
    std::uint32_t version = 0;
    double plan_time_s = 0.0;  // at `at`
    double rate = 0.0;
    SteadyTime at;
  };
  double age_s(const Beat& beat, SteadyTime now);

  Duration silence_;
  std::uint32_t version_ = 0;         // of the plan followed; 0: none
  std::optional<Received> received_;  // newest heartbeat of the plan followed
  std::optional<Received> other_;     // newest of another one, which may be received next
  double highest_s_ = 0.0;            // τ given out for this flow
  bool any_ = false;
  std::int64_t window_began_ns_ = 0;
  std::int64_t least_ns_ = 0;         // least receipt − stamp in this window
  std::int64_t least_before_ns_ = 0;  // least receipt − stamp in the window before
};

}  // namespace swarm::agent
