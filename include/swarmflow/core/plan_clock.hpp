// SPDX-FileCopyrightText: The Swarmflow authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "swarmflow/core/time.hpp"

namespace swarm {

/// A reading of the plan's clock: plan time τ of one plan, and the rate at which it advances from
/// then on.
///
///   τ(t) = plan_time_s + rate (t − stamp)      until the next reading of the same clock
///
/// A plan's clock starts at 0 when the plan is published, never goes back, and slows down when the
/// swarm falls behind: the mixture that the swarm is to form at t is FlowPlan::mixture_at(τ(t)).
struct PlanClock {
  UtcTime stamp{};                 ///< time of the reading, by the planner's clock
  std::uint32_t plan_version = 0;  ///< version of the plan it belongs to; 0: there is no plan yet
  double plan_time_s = 0.0;        ///< τ at `stamp` [s]
  double rate = 0.0;               ///< dτ/dt, in [0, 1]

  /// τ(t) by the formula above [s], also for t before `stamp`.
  double plan_time_at_s(UtcTime t) const { return plan_time_s + rate * to_seconds(t - stamp); }
};

/// A reading as one line of the run directory's `plan_clock.jsonl`, with the newline. The planner
/// appends one for every change of version or rate:
///
///   {"utc_ns": …, "plan_version": 1, "plan_time_s": 12.5, "rate": 1}
std::string plan_clock_line(const PlanClock& clock);

/// Reads the content of a `plan_clock.jsonl`. Lines that cannot be parsed, run back in time or have
/// a rate outside [0, 1] are skipped, since the last line of a planner that was killed may be cut.
/// \return readings with ascending stamps
std::vector<PlanClock> read_plan_clock(std::string_view lines);

/// The reading in force at t: the newest one not after t; null before the first. O(log n); the
/// pointer is into `readings`. \pre stamps ascend
const PlanClock* clock_at(std::span<const PlanClock> readings, UtcTime t);

}  // namespace swarm
