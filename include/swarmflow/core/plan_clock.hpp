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

/// The plan's clock at a moment: plan time τ of a plan, and how fast it advances from then on.
///
///   τ(t) = plan_time_s + rate (t − stamp)      until the next reading of the same clock
///
/// A plan's clock starts at 0 when the plan is issued, never goes back, and slows down when the
/// swarm falls behind: the mixture that the swarm is to form at t is mixture_at(τ(t)).
struct PlanClock {
  UtcTime stamp{};
  std::uint32_t plan_version = 0;  ///< 0: there is no plan yet
  double plan_time_s = 0.0;        ///< τ at `stamp` [s]
  double rate = 0.0;               ///< dτ/dt, in [0, 1]

  double plan_time_at_s(UtcTime t) const { return plan_time_s + rate * to_seconds(t - stamp); }
};

/// One line of `plan_clock.jsonl`, which has one for every change of version or rate:
///
///   {"utc_ns": …, "plan_version": 1, "plan_time_s": 12.5, "rate": 1}
std::string plan_clock_line(const PlanClock& clock);

/// Reads such a file. Lines that are none, run back in time or have a rate outside [0, 1] are left
/// out, as the last line of a planner that was killed may be cut.
std::vector<PlanClock> read_plan_clock(std::string_view lines);

/// The reading that holds at t: the newest one not after t. Null before the first.
/// \pre stamps ascend
const PlanClock* clock_at(std::span<const PlanClock> readings, UtcTime t);

}  // namespace swarm
